// Did the episode do what its task asks? Judged on the simulated states alone, step by step.
#pragma once
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "host/physics/simulation.hpp"
#include "host/scene/task.hpp"

namespace pvg {

// What was measured over an episode. Distances [m], angles [rad].
struct Measured {
  double lifted = 0;              // highest rise of the object's origin above its start
  double moved_in_hand = 0;       // largest move of its origin in the tool's frame from the end of `close` to `open`
  double slip_in_hand = 0;        // while carried: largest move of a patch of contact against the object, see below
  double position_error = 0;      // at the end: distance of the object's origin from its target
  double tilt = 0;                // at the end: angle between the object's z axis and the vertical
  double finger_deformation = 0;  // largest move of a soft node against the rigid body that it is stitched to
  bool is_held = false;           // at the end: something soft touches the object
};

// Which steps count as what: the element under way in each step.
enum class Phase { free, holding, carrying };

// Watches the steps in order. The slip is that of the soft nodes that bear the object: those of the soft bodies' nodes
// that are nearest to the contacts with the object when carrying begins. Per soft body, slip is the length of the mean
// displacement of these nodes as seen from the object; the compliance of the fingers does not enter it.
class SuccessMonitor {
 public:
  // tool: body that carries the gripper
  SuccessMonitor(const SuccessConditions& conditions, const Scene& scene, int tool, const SceneState& start);
  void observe(const WorldState& state, Phase phase);
  const Measured& measured() const { return measured_; }
  // Nothing if every condition holds, else the first that does not, in words.
  std::optional<std::string> failure() const;

 private:
  struct Patch {
    std::vector<std::size_t> nodes;  // of one soft body
    std::vector<Vec3> start;         // in the object's frame [m]
  };
  void start_patches(const WorldState& state);
  void measure_deformation(const WorldState& state);

  const SuccessConditions conditions_;
  const Scene& scene_;
  int object_, target_, tool_;
  double start_height_;
  std::vector<int> carriage_;             // of each soft body, -1: not stitched
  std::vector<std::vector<Vec3>> rest_;   // soft nodes in their carriage's frame at the start
  std::optional<Vec3> held_at_;           // object's origin in the tool's frame when the gripper had closed
  std::optional<double> dropped_at_;      // time [s]
  std::map<std::size_t, Patch> patches_;  // by soft body
  bool has_carried_ = false;
  Measured measured_;
};

// The phase of each step: holding from the end of a `close` to the next `open`, carrying in the `carry` of it.
std::vector<Phase> phases(const std::vector<MotionElement>& elements, const std::vector<int>& element_of_step);

}  // namespace pvg
