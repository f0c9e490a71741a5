#include "host/robot/plan_motion.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "host/base/counted.hpp"
#include "host/base/error.hpp"
#include "host/robot/joint_path.hpp"
#include "host/robot/motion_check.hpp"
#include "host/robot/motion_timing.hpp"

namespace pvg {
namespace {

constexpr double KNOT_DISTANCE = 0.005;  // of a straight line of the tool [m]
constexpr double KNOT_ANGLE = 0.03;      // [rad]
constexpr double LARGEST_JUMP = 0.15;    // of a joint between two knots: more is another branch of solutions [rad]
constexpr double END_MARGIN = 0.02;      // kept from the joints' ends [rad]
constexpr int CANDIDATES = 6;            // configurations of a target that are tried, nearest first
constexpr int MOST_ATTEMPTS = 60;        // of planning the rest of the motion after such a choice

// One robot: a choice of paths for its elements such that each can begin where the one before it ended.
struct Planner {
  const RobotModel& model;
  const MotionSetup& setup;
  std::span<const MotionElement> elements;  // of all robots
  int robot = 0;
  std::vector<RobotJoint> joints;                // those that move
  std::vector<std::optional<Segment>> segments;  // [n_elements]; nothing: not planned yet, or of another robot
  std::size_t deepest = 0;                       // element of the failure that is reported
  std::string failure;
  int attempts = 0;
};

std::string describe(const Planner& planner, std::size_t index) { return describe_element(planner.elements, index); }

bool fail(Planner& planner, std::size_t index, const std::string& reason) {
  if (planner.failure.empty() || index > planner.deepest) {
    planner.deepest = index;
    planner.failure = describe(planner, index) + ": " + reason;
  }
  return false;
}

Pose current_pose(const Planner& planner, const VectorXd& q) {
  return tool_pose(planner.model, q, planner.setup.tool_link, planner.setup.flange_to_tool);
}

InverseKinematics settings() { return {.tolerance = 1e-9, .margin = END_MARGIN}; }

// The frame in which the element gives what it gives, in the base's frame.
Pose given_frame(const Planner& planner, std::size_t index, const RobotState& state) {
  const MotionElement& element = planner.elements[index];
  if (element.is_in_tool_frame) return current_pose(planner, state.q);
  if (element.object.empty()) return planner.setup.base.inverse();
  const auto object = planner.setup.objects.find(element.object);
  if (object == planner.setup.objects.end())
    throw UsageError(describe(planner, index) + ": there is no object of that name in the scene; correct the name");
  return planner.setup.base.inverse() * object->second;
}

// A way of the tool: its pose at s in [0, 1], and how many knots its length asks for.
struct ToolPath {
  std::function<Pose(double)> at;
  int knots = 8;
};

int knots_for(double length, double angle) {
  return std::max(8, int(std::ceil(std::max(length / KNOT_DISTANCE, angle / KNOT_ANGLE))));
}

ToolPath straight_path(const Pose& start, const Pose& target) {
  const auto difference = pose_difference(start, target);
  const Eigen::Quaterniond turn_start(start.linear()), turn_end(target.linear());
  const auto at = [=](double s) {
    Pose pose(turn_start.slerp(s, turn_end));
    pose.translation() = (1 - s) * start.translation() + s * target.translation();
    return pose;
  };
  return {at, knots_for(difference.head<3>().norm(), difference.tail<3>().norm())};
}

// About an axis that goes through `center` along the unit vector `axis`.
ToolPath arc_path(const Pose& start, const Vec3& center, const Vec3& axis, double angle, bool turns) {
  const auto at = [=](double s) {
    const Mat3 turn = Eigen::AngleAxisd(s * angle, axis).toRotationMatrix();
    Pose pose = start;
    pose.translation() = center + turn * (start.translation() - center);
    if (turns) pose.linear() = turn * start.linear();
    return pose;
  };
  const Vec3 arm = start.translation() - center;
  return {at, knots_for((arm - axis.dot(arm) * axis).norm() * std::abs(angle), turns ? std::abs(angle) : 0)};
}

// The cubic spline through the poses: positions, and rotation vectors against the start.
ToolPath curved_path(const Pose& start, const std::vector<Pose>& through) {
  Eigen::MatrixXd knots(Eigen::Index(through.size()) + 1, 6);
  knots.row(0) << start.translation().transpose(), 0, 0, 0;
  double length = 0, angle = 0;
  for (std::size_t i = 0; i < through.size(); ++i) {
    const auto difference = pose_difference(start, through[i]);
    knots.row(Eigen::Index(i) + 1) << through[i].translation().transpose(), difference.tail<3>().transpose();
    const Eigen::VectorXd way = knots.row(Eigen::Index(i) + 1) - knots.row(Eigen::Index(i));
    length += way.head<3>().norm();
    angle += way.tail<3>().norm();
  }
  const auto at = [start, curve = JointPath(knots)](double s) {
    const Eigen::VectorXd x = curve.at(s).q;
    const Vec3 turn = x.tail<3>();
    Pose pose = start;
    pose.translation() = x.head<3>();
    if (turn.norm() > 1e-12)
      pose.linear() = Eigen::AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix() * start.linear();
    return pose;
  };
  return {at, knots_for(1.5 * length, 1.5 * angle)};
}

// Knots of inverse kinematics along the tool's way; fewer than asked where it cannot go on.
std::vector<VectorXd> follow_path(const Planner& planner, const VectorXd& q_start, const ToolPath& way) {
  std::vector<VectorXd> knots = {q_start};
  for (int k = 1; k <= way.knots; ++k) {
    const auto q = follow_pose(planner.model, planner.setup.tool_link, planner.setup.flange_to_tool,
                               way.at(double(k) / way.knots), knots.back(), settings());
    if (!q || (*q - knots.back()).cwiseAbs().maxCoeff() > LARGEST_JUMP) break;
    knots.push_back(*q);
  }
  return knots;
}

// The tool's way that the element asks for; nothing where the arm may take any.
std::optional<ToolPath> tool_path(const Planner& planner, std::size_t index, const RobotState& state) {
  const MotionElement& element = planner.elements[index];
  const GivenMotion given = kind_of(element).given;
  const Pose frame = given_frame(planner, index, state), start = current_pose(planner, state.q);
  if (given == GivenMotion::arc)
    return arc_path(start, frame * element.center, frame.linear() * element.axis, element.angle,
                    element.turns_with_arc);
  if (given == GivenMotion::path) {
    std::vector<Pose> through;
    for (const Pose& pose : element.path) through.push_back(frame * pose);
    return curved_path(start, through);
  }
  if (element.is_straight) return straight_path(start, frame * element.target);
  return std::nullopt;
}

// The path between two configurations: straight in the joint space, or searched.
std::optional<JointPath> path_between(Planner& planner, std::size_t index, const RobotState& state, const VectorXd& q) {
  Eigen::MatrixXd knots(2, q.size());
  knots << state.q.transpose(), q.transpose();
  if (!planner.elements[index].avoids_obstacles) return JointPath(knots);
  if (!planner.setup.plan_path)
    throw UsageError(describe(planner, index) + ": no planner of paths around obstacles is set; leave `plan` out");
  const auto way = planner.setup.plan_path(state.q, q);
  if (!way) return std::nullopt;
  return JointPath(*way);
}

// Paths to the target, best first; empty after a failure that is noted.
std::vector<JointPath> find_paths(Planner& planner, std::size_t index, const RobotState& state) {
  const std::optional<ToolPath> way = tool_path(planner, index, state);
  const Pose target = way ? way->at(1) : given_frame(planner, index, state) * planner.elements[index].target;
  const Vec3 p = target.translation();
  const std::string where = fmt::format("({:.3f}, {:.3f}, {:.3f}) m in the robot's base frame, {:.3f} m from the base",
                                        p.x(), p.y(), p.z(), p.norm());
  if (way) {
    const std::vector<VectorXd> line = follow_path(planner, state.q, *way);
    if (int(line.size()) == way->knots + 1) {
      Eigen::MatrixXd matrix(Eigen::Index(line.size()), state.q.size());
      for (std::size_t k = 0; k < line.size(); ++k) matrix.row(Eigen::Index(k)) = line[k];
      return {JointPath(matrix)};
    }
    fail(planner, index,
         std::string("the tool's ") + (planner.elements[index].is_straight ? "straight line" : "way") + " to " + where +
             fmt::format(", leaves what the joints allow after {:.0f} % of its length",
                         100.0 * double(line.size() - 1) / way->knots) +
             "; move the target, or let the tool go on a line that is not straight");
    return {};
  }
  InverseKinematics search = settings();
  search.n_solutions = CANDIDATES;
  const VectorXd& wanted = planner.setup.posture.size() ? planner.setup.posture : state.q;
  std::vector<JointPath> paths;
  for (VectorXd q :
       reach_pose(planner.model, planner.setup.tool_link, planner.setup.flange_to_tool, target, wanted, search)) {
    // the elbow of a redundant arm is free: take it as near to what is wanted as it goes
    InverseKinematics nearer = settings();
    nearer.max_iterations = 300;
    nearer.posture = wanted;
    nearer.posture_gain = 0.2;
    const auto better =
        follow_pose(planner.model, planner.setup.tool_link, planner.setup.flange_to_tool, target, q, nearer);
    if (better && (*better - wanted).norm() < (q - wanted).norm()) q = *better;
    if (const auto path = path_between(planner, index, state, q)) paths.push_back(*path);
  }
  if (paths.empty())
    fail(planner, index,
         "its target at " + where + ", cannot be reached within the joint limits" +
             (planner.elements[index].avoids_obstacles ? " and around what stands in the way" : "") +
             "; move it or the robot");
  return paths;
}

// Whether an element can be done in the time that it is given; a failure is noted.
bool has_time(Planner& planner, std::size_t index, double needed) {
  const double wanted = planner.elements[index].duration;
  if (!std::isfinite(needed))
    return fail(planner, index,
                "a joint would have to move where its velocity limit is zero, next to its end; move the target");
  if (wanted > 0 && wanted < needed)
    return fail(planner, index,
                fmt::format("its duration of {:.3f} s is shorter than the {:.3f} s that the limits of velocity and "
                            "acceleration ask for; give more time",
                            wanted, needed));
  return true;
}

bool plan_from(Planner& planner, std::size_t index, const RobotState& state);

bool take(Planner& planner, std::size_t index, const Segment& segment) {
  if (!has_time(planner, index, segment.needed)) return false;
  planner.segments[index] = segment;
  return plan_from(planner, index + 1, segment.end);
}

bool plan_gripper(Planner& planner, std::size_t index, const RobotState& state) {
  RobotState end = state;
  end.gripper = planner.elements[index].gripper;
  const double way = std::abs(end.gripper - state.gripper);
  // the largest s' and s'' of the time law are 15/8 and 10/sqrt(3)
  const double needed = std::max(1.875 * way / planner.setup.gripper_speed,
                                 std::sqrt(10 / std::sqrt(3.0) * way / planner.setup.gripper_acceleration));
  return take(planner, index, {std::nullopt, state, end, needed});
}

bool plan_move(Planner& planner, std::size_t index, const RobotState& state) {
  const MotionElement& element = planner.elements[index];
  if (!(element.speed > 0 && element.speed <= 1))
    throw UsageError(describe(planner, index) + ": its speed is a share of the limits, so give a number in (0, 1]");
  for (const JointPath& path : find_paths(planner, index, state)) {
    if (++planner.attempts > MOST_ATTEMPTS) return false;
    const double needed = shortest_duration(path, planner.joints,
                                            {.share = element.speed,
                                             .default_acceleration = planner.setup.default_acceleration,
                                             .default_jerk = planner.setup.default_jerk});
    if (take(planner, index, {path, state, {path.end(), state.gripper}, needed})) return true;
  }
  return false;
}

// Plans element `index` and all after it, going back to another configuration where the rest turns out impossible.
bool plan_from(Planner& planner, std::size_t index, const RobotState& state) {
  while (index < planner.elements.size() && planner.elements[index].robot != planner.robot) ++index;
  if (index == planner.elements.size()) return true;
  switch (kind_of(planner.elements[index]).given) {
    case GivenMotion::duration:
      return take(planner, index, {std::nullopt, state, state, 0});
    case GivenMotion::gripper_position:
      return plan_gripper(planner, index, state);
    default:
      return plan_move(planner, index, state);
  }
}

void check(const RobotModel& model, const MotionSetup& setup) {
  if (!(setup.time_step > 0)) throw UsageError("the time step of a motion must be positive; correct time_step");
  if (setup.tool_link < 0 || setup.tool_link >= int(model.links.size()))
    throw UsageError("robot '" + model.name + "' has no link number " + std::to_string(setup.tool_link) +
                     " to carry the tool; name one of its links");
  if (std::size_t(setup.q_start.size()) != model.actuated.size())
    throw UsageError("robot '" + model.name + "' has " + counted(model.actuated.size(), "moving joint") +
                     " but its start configuration has " + std::to_string(setup.q_start.size()) +
                     "; give one position for each");
}

}  // namespace

JointTrajectory plan_motion(const RobotModel& model, const MotionSetup& setup,
                            std::span<const MotionElement> elements) {
  const PlannedRobot robot{model, setup};
  return plan_motion(std::span(&robot, 1), elements).front();
}

std::vector<JointTrajectory> plan_motion(std::span<const PlannedRobot> robots,
                                         std::span<const MotionElement> elements) {
  std::vector<Planner> planners;
  for (const PlannedRobot& robot : robots) {
    check(robot.model, robot.setup);
    Planner& planner =
        planners.emplace_back(Planner{robot.model, robot.setup, elements, int(planners.size()), {}, {}, 0, {}, 0});
    planner.segments.resize(elements.size());
    for (const int joint : robot.model.actuated) planner.joints.push_back(robot.model.joints[joint]);
    if (!plan_from(planner, 0, {robot.setup.q_start, robot.setup.gripper_start})) throw UsageError(planner.failure);
  }
  std::vector<RobotMotion> motions;
  for (const Planner& planner : planners) motions.push_back({planner.model, planner.setup, planner.segments});
  const std::vector<ElementGroup> groups = time_elements(motions, elements);
  std::vector<JointTrajectory> trajectories;
  for (const RobotMotion& motion : motions) {
    const JointTrajectory& trajectory = trajectories.emplace_back(sample_motion(motion, groups));
    const auto left = limit_left(motion.model, motion.setup.q_start, trajectory.q, trajectory.time_step);
    if (left)
      throw UsageError("the planned motion leaves a limit of the robot: " + *left + "; lower `speed`" +
                       (any_blends(elements) ? " or `blend_radius`" : ""));
  }
  return trajectories;
}

}  // namespace pvg
