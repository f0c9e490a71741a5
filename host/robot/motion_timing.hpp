// When a planned motion is where: the paths of its elements get steps of time. An element moves from rest to rest by
// the time law of joint_path.hpp and rests then, unless it is blended with the next one (`blend_radius`): the two go on
// at once, as long as the tool is within that radius r of the target w between them on both of their ways,
//   q(t) = q_a(t) + q_b(t) - q_w,
// for at most half the time of each. Velocity and acceleration stay continuous, and the tool stays within about r of
// both ways, since |x_a - w| and |x_b - w| are at most r.
#pragma once
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "host/robot/joint_path.hpp"
#include "host/robot/plan_motion.hpp"

namespace pvg {

struct RobotState {
  VectorXd q;      // [n_actuated, rad]
  double gripper;  // [m]
};

// What one element does to its robot, still without time.
struct Segment {
  std::optional<JointPath> path;  // of the arm; nothing: it stands still
  RobotState start, end;
  double needed = 0;  // shortest time that the limits allow [s]
};

struct RobotMotion {
  const RobotModel& model;
  const MotionSetup& setup;
  std::span<const std::optional<Segment>> segments;  // [n_elements]; nothing: of another robot
};

// Elements [first, last) that go on together.
struct ElementGroup {
  std::size_t first = 0, last = 0;
  int start = 0;   // step before which they begin
  int moving = 0;  // steps that they move
  int rest = 0;    // steps that they stand still then
  int shared = 0;  // of those that move, with the group before: both go on
};

// Names an element for messages: file and line, number, kind, object.
std::string describe_element(std::span<const MotionElement> elements, std::size_t index);

bool any_blends(std::span<const MotionElement> elements);

// Throws a UsageError that names the element where `blend_radius` has nothing to blend.
std::vector<ElementGroup> time_elements(std::span<const RobotMotion> robots, std::span<const MotionElement> elements);

JointTrajectory sample_motion(const RobotMotion& robot, std::span<const ElementGroup> groups);

}  // namespace pvg
