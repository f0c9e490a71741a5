#include "host/robot/motion_timing.hpp"

#include <algorithm>
#include <cmath>

#include "host/base/error.hpp"

namespace pvg {
namespace {

int steps_for(double seconds, double time_step) { return int(std::ceil(seconds / time_step - 1e-9)); }

bool moves_arm(const MotionElement& element) {
  const GivenMotion given = kind_of(element).given;
  return given != GivenMotion::duration && given != GivenMotion::gripper_position;
}

// Position of the robot at the share u of a segment's time.
Eigen::RowVectorXd position(const Segment& segment, double u, int n_gripper_joints) {
  const double s = smoothstep(u).value;
  Eigen::RowVectorXd row(segment.end.q.size() + n_gripper_joints);
  row.head(segment.end.q.size()) = segment.path ? segment.path->at(s).q : segment.end.q;
  row.tail(n_gripper_joints).setConstant(segment.start.gripper + s * (segment.end.gripper - segment.start.gripper));
  return row;
}

// Steps of a segment from its start on, or back from its end, at which the tool is within the radius [m] of where it
// is there.
int steps_within(const RobotMotion& robot, const Segment& segment, int moving, bool from_end, double radius) {
  const auto place = [&](int step) {
    const VectorXd q = position(segment, double(step) / moving, 0).transpose();
    return Vec3(tool_pose(robot.model, q, robot.setup.tool_link, robot.setup.flange_to_tool).translation());
  };
  const Vec3 center = place(from_end ? moving : 0);
  int n = 0;
  while (n < moving && (place(from_end ? moving - n - 1 : n + 1) - center).norm() <= radius) ++n;
  return n;
}

// Refuses a blend that has no next element of the same arm alone.
void check_blend(std::span<const MotionElement> elements, const ElementGroup& group) {
  for (std::size_t i = group.first; i < group.last; ++i) {
    if (elements[i].blend_radius <= 0) continue;
    const std::size_t next = i + 1;
    const bool is_alone = group.last == group.first + 1 && next < elements.size() &&
                          (next + 1 == elements.size() || !elements[next + 1].is_with_previous);
    if (!is_alone || !moves_arm(elements[next]) || elements[next].robot != elements[i].robot)
      throw UsageError(describe_element(elements, i) +
                       ": `blend_radius` needs a next element that moves the same arm, and neither of the two together "
                       "with others; leave it out, then the arm stops here");
  }
}

// Steps for which the group may go on while the next one has begun; one element each.
int shared_steps(const RobotMotion& robot, const ElementGroup& group, const ElementGroup& next, double radius) {
  const int arriving = steps_within(robot, *robot.segments[group.first], group.moving, true, radius);
  const int leaving = steps_within(robot, *robot.segments[next.first], next.moving, false, radius);
  return std::min({arriving, leaving, group.moving / 2, next.moving / 2});
}

}  // namespace

std::string describe_element(std::span<const MotionElement> elements, std::size_t index) {
  const MotionElement& element = elements[index];
  const std::string object = element.object.empty() ? "" : " relative to '" + element.object + "'";
  return (element.place.empty() ? "" : element.place + ": ") + "motion element " + std::to_string(index + 1) + " (" +
         kind_of(element).name + object + ")";
}

bool any_blends(std::span<const MotionElement> elements) {
  return std::any_of(elements.begin(), elements.end(), [](const MotionElement& e) { return e.blend_radius > 0; });
}

std::vector<ElementGroup> time_elements(std::span<const RobotMotion> robots, std::span<const MotionElement> elements) {
  std::vector<ElementGroup> groups;
  for (std::size_t i = 0; i < elements.size(); ++i) {
    if (i == 0 || !elements[i].is_with_previous) groups.push_back({.first = i});
    ElementGroup& group = groups.back();
    group.last = i + 1;
    const RobotMotion& robot = robots[std::size_t(elements[i].robot)];
    const double seconds = std::max(elements[i].duration, robot.segments[i]->needed);
    // a wait of no time still takes none; anything that moves takes at least a step
    const bool waits = kind_of(elements[i]).given == GivenMotion::duration;
    group.moving = std::max({group.moving, steps_for(seconds, robot.setup.time_step), waits ? 0 : 1});
  }
  int start = 0;
  for (std::size_t g = 0; g < groups.size(); ++g) {
    ElementGroup& group = groups[g];
    check_blend(elements, group);
    const MotionElement& element = elements[group.first];
    const RobotMotion& robot = robots[std::size_t(element.robot)];
    group.start = start;
    if (element.blend_radius > 0)
      groups[g + 1].shared = shared_steps(robot, group, groups[g + 1], element.blend_radius);
    else
      group.rest = steps_for(robot.setup.rest, robot.setup.time_step);
    start += group.moving + group.rest - (g + 1 < groups.size() ? groups[g + 1].shared : 0);
  }
  return groups;
}

JointTrajectory sample_motion(const RobotMotion& robot, std::span<const ElementGroup> groups) {
  const MotionSetup& setup = robot.setup;
  JointTrajectory trajectory;
  trajectory.time_step = setup.time_step;
  const int n_steps = groups.empty() ? 0 : groups.back().start + groups.back().moving + groups.back().rest;
  trajectory.q.resize(n_steps, setup.q_start.size() + setup.n_gripper_joints);
  trajectory.element.resize(std::size_t(n_steps));
  Segment still{std::nullopt, {setup.q_start, setup.gripper_start}, {setup.q_start, setup.gripper_start}, 0};
  for (const ElementGroup& group : groups) {
    Segment segment = still;
    for (std::size_t i = group.first; i < group.last; ++i)
      if (robot.segments[i]) segment = *robot.segments[i];
    const Eigen::RowVectorXd begin = position(segment, 0, setup.n_gripper_joints);
    for (int k = 0; k < group.moving + group.rest; ++k) {
      const double u = k < group.moving ? double(k + 1) / group.moving : 1;
      const Eigen::RowVectorXd at = position(segment, u, setup.n_gripper_joints);
      auto row = trajectory.q.row(group.start + k);
      if (k < group.shared)
        row += at - begin;
      else
        row = at;
      trajectory.element[std::size_t(group.start + k)] = int(group.first);
    }
    still.start = still.end = segment.end;
  }
  return trajectory;
}

}  // namespace pvg
