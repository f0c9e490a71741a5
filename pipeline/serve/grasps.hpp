// What hands do to objects, told from contacts and widths of grippers alone: where no motion is planned, no element
// says when a hand holds and carries. And the events of an episode that follow from it.
#pragma once
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "host/load/build_scene.hpp"
#include "host/model/world_state.hpp"
#include "pipeline/episode/success.hpp"

namespace pvg {

struct EpisodeEvent {
  std::string name;  // grasped, carried, dropped, slipped, bumped, at_stop, out_of_reach
  std::string of;    // object, joint or column of actions
  double time = 0;   // [s]
};

// Watches the steps in order.
//   holding    two fingers of a hand (one, where it has one) touch an object that can move, the gripper is narrower
//   than
//              at the start and has come to rest; from then on until fewer fingers touch the object
//   carrying   and nothing else touches the object
class Grasps {
 public:
  // The scene must outlive it.
  explicit Grasps(const TaskScene& built);
  void observe(const WorldState& state);
  const std::vector<Phase>& phase() const { return phase_; }  // of each robot
  // An event that others saw; once, as all are.
  void add(const std::string& name, const std::string& of, double time);
  // each name once per object or joint, in the order of time
  const std::vector<EpisodeEvent>& events() const { return events_; }

 private:
  // Which bodies touch each body, in the order of ContactForce::first.
  using Touching = std::vector<std::vector<int>>;
  // An object that a hand carried and let go of, until it touches something else.
  struct Falling {
    int body = -1;
    double height = 0;  // of its origin when it was let go of [m]
  };
  int held_by(std::size_t robot, const Touching& touching) const;
  bool touched_by_hand_alone(std::size_t robot, const std::vector<int>& others) const;
  void observe_fall(std::size_t robot, const WorldState& state, const Touching& touching);
  double width(std::size_t robot, const WorldState& state) const;
  void observe_hand(std::size_t robot, const WorldState& state, const Touching& touching);
  void observe_accidents(const WorldState& state, const Touching& touching);

  const TaskScene& built_;
  std::vector<Hand> hands_;
  std::vector<char> is_robot_, is_finger_, can_move_;  // [n_bodies]
  std::vector<double> width_at_start_, width_before_;  // [n_robots, m] sum of the gripper's joints
  std::vector<int> held_;                              // [n_robots] body, -1: none
  std::vector<std::optional<Vec3>> held_at_;           // [n_robots] origin of a rigid one in the hand
  std::vector<std::optional<Falling>> falling_;        // [n_robots]
  std::vector<Phase> phase_;
  double time_before_ = 0;
  std::set<std::pair<std::string, std::string>> known_;
  std::vector<EpisodeEvent> events_;
};

}  // namespace pvg
