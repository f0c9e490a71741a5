// Did the episode do what its task asks? Judged on the simulated states alone, step by step.
#pragma once
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "host/load/build_scene.hpp"
#include "host/model/task.hpp"
#include "host/physics/step/simulation.hpp"

namespace pvg {

// What was measured over an episode: one number per condition, and what every grasp is measured by.
struct Measured {
  struct Number {
    std::string name;  // such as lifted_m; with the body's name before it where several conditions share it
    double value = 0;  // what counts of it: the last, or the largest or smallest of all steps
  };
  std::vector<Number> numbers;
  double finger_deformation = 0;  // largest move of a soft node against the rigid body that it is stitched to [m]

  double operator[](const std::string& name) const;  // throws std::out_of_range where nothing has the name
};

// Which steps count as what for a robot: the element under way.
enum class Phase { free, holding, carrying };

// A gripper, by the bodies of the scene.
struct Hand {
  int base = -1;             // rigid body that carries it
  std::vector<int> fingers;  // bodies: rigid ones, then soft ones at n_rigid + i
};
std::vector<Hand> hands_of(const TaskScene& built);

// Watches the steps in order. The slip is that of the soft nodes that bear the object: those of the soft bodies' nodes
// that are nearest to the contacts with the object when carrying begins. Per soft body, slip is the length of the mean
// displacement of these nodes as seen from the object; the compliance of the fingers does not enter it.
class SuccessMonitor {
 public:
  SuccessMonitor(const Task& task, const Scene& scene, std::span<const Hand> hands, const SceneState& start);
  // phase: of each robot
  void observe(const WorldState& state, std::span<const Phase> phase);
  Measured measured() const;
  // Nothing if every condition holds, else the first that does not, in words.
  std::optional<std::string> failure() const;

 private:
  struct Patch {
    std::vector<std::size_t> nodes;  // of one soft body
    std::vector<Vec3> start;         // in the object's frame [m]
  };
  // A condition with what it names found in the scene, and what was seen of it so far.
  struct Watched {
    Condition condition;
    int body = -1;  // object: rigid body; cloth: of Scene::cloths
    bool is_cloth = false;
    int target = -1;  // rigid body
    int joint = -1;
    std::vector<std::array<std::size_t, 2>> pairs;  // of the cloth's points, whose distance counts
    double start_height = 0;                        // [m]
    std::optional<Vec3> held_at;                    // object's origin in the hand when the grip had closed
    std::map<std::size_t, Patch> patches;           // by soft body
    bool was_carrying = false;
    double last = 0, largest = 0, smallest = 0;  // of its quantity
    bool is_number = true;                       // false: a step had none
    std::optional<double> first_time;            // when it first held, of failures and `some_time` [s]
    std::optional<double> broken_at;             // when it first did not, of `always` [s]
  };
  Watched watch(const Condition& condition) const;
  double quantity(Watched& watched, const WorldState& state, std::span<const Phase> phase) const;
#define PVG_MEASURE(name, unit, of, keys) \
  double name(Watched& watched, const WorldState& state, std::span<const Phase> phase) const;
  PVG_QUANTITIES(PVG_MEASURE)  // one function per quantity
#undef PVG_MEASURE
  static const AffineMap& object(const Watched& watched, const WorldState& state) {
    return state.rigid.at(std::size_t(watched.body));
  }
  void update(Watched& watched, const WorldState& state, std::span<const Phase> phase) const;
  void measure_deformation(const WorldState& state);

  const Scene& scene_;
  const std::vector<Hand> hands_;
  std::vector<Watched> success_, failure_;
  std::vector<int> carriage_;            // of each soft body, -1: not stitched
  std::vector<std::vector<Vec3>> rest_;  // soft nodes in their carriage's frame at the start
  double finger_deformation_ = 0;
  std::size_t n_steps_ = 0;
};

// The phases of each step, of each robot: holding from the end of a `close` to the next `open`, carrying in a `carry`,
// follow_arc or follow_path of it.
std::vector<std::vector<Phase>> phases(const std::vector<MotionElement>& elements,
                                       const std::vector<int>& element_of_step, int n_robots);

}  // namespace pvg
