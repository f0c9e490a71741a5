#include "host/robot/plan_motion.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "host/base/error.hpp"
#include "host/robot/joint_path.hpp"

namespace pvg {
namespace {

constexpr double KNOT_DISTANCE = 0.005;  // of a straight line of the tool [m]
constexpr double KNOT_ANGLE = 0.03;      // [rad]
constexpr double LARGEST_JUMP = 0.15;    // of a joint between two knots: more is another branch of solutions [rad]
constexpr double END_MARGIN = 0.02;      // kept from the joints' ends [rad]
constexpr int CANDIDATES = 6;            // configurations of a target that are tried, nearest first
constexpr int MOST_ATTEMPTS = 60;        // of planning the rest of the motion after such a choice

using Rows = Eigen::MatrixXd;  // [n_steps, n_actuated + n_gripper_joints]

struct RobotState {
  VectorXd q;      // [n_actuated, rad]
  double gripper;  // [m]
};

struct Planner {
  const RobotModel& model;
  const MotionSetup& setup;
  std::span<const MotionElement> elements;
  std::vector<RobotJoint> joints;  // those that move
  std::vector<Rows> rows;          // of each element that is planned
  std::size_t deepest = 0;         // element of the failure that is reported
  std::string failure;
  int attempts = 0;
};

std::string text(const char* format, double a, double b = 0, double c = 0, double d = 0) {
  std::array<char, 200> buffer;
  std::snprintf(buffer.data(), buffer.size(), format, a, b, c, d);
  return buffer.data();
}

std::string describe(const Planner& planner, std::size_t index) {
  static constexpr std::array names = {"approach", "close", "lift", "carry", "lower", "open", "retreat", "wait"};
  const MotionElement& element = planner.elements[index];
  const std::string object = element.object.empty() ? "" : " relative to '" + element.object + "'";
  return "motion element " + std::to_string(index + 1) + " (" + names[std::size_t(element.type)] + object + ")";
}

bool fail(Planner& planner, std::size_t index, const std::string& reason) {
  if (planner.failure.empty() || index > planner.deepest) {
    planner.deepest = index;
    planner.failure = describe(planner, index) + ": " + reason;
  }
  return false;
}

int steps_for(double seconds, double time_step) { return int(std::ceil(seconds / time_step - 1e-9)); }

Rows repeated(const Planner& planner, const RobotState& state, int n_steps) {
  const auto n = state.q.size();
  Rows rows(n_steps, n + planner.setup.n_gripper_joints);
  for (int k = 0; k < n_steps; ++k) {
    rows.row(k).head(n) = state.q;
    rows.row(k).tail(planner.setup.n_gripper_joints).setConstant(state.gripper);
  }
  return rows;
}

// target tool pose in the base's frame
Pose target_pose(const Planner& planner, std::size_t index) {
  const MotionElement& element = planner.elements[index];
  Pose world = element.target;
  if (!element.object.empty()) {
    const auto object = planner.setup.objects.find(element.object);
    if (object == planner.setup.objects.end())
      throw UsageError(describe(planner, index) + ": there is no object of that name in the scene; correct the name");
    world = object->second * element.target;
  }
  return planner.setup.base.inverse() * world;
}

Pose current_pose(const Planner& planner, const VectorXd& q) {
  return tool_pose(planner.model, q, planner.setup.tool_link, planner.setup.flange_to_tool);
}

InverseKinematics settings() { return {.tolerance = 1e-9, .margin = END_MARGIN}; }

// Knots of inverse kinematics along the straight line of the tool; fewer than asked where it cannot go on.
std::vector<VectorXd> follow_line(const Planner& planner, const VectorXd& q_start, const Pose& target, int n) {
  const Pose start = current_pose(planner, q_start);
  const Eigen::Quaterniond turn_start(start.linear()), turn_end(target.linear());
  std::vector<VectorXd> knots = {q_start};
  for (int k = 1; k <= n; ++k) {
    const double s = double(k) / n;
    Pose pose(turn_start.slerp(s, turn_end));
    pose.translation() = (1 - s) * start.translation() + s * target.translation();
    const auto q = follow_pose(planner.model, planner.setup.tool_link, planner.setup.flange_to_tool, pose, knots.back(),
                               settings());
    if (!q || (*q - knots.back()).cwiseAbs().maxCoeff() > LARGEST_JUMP) break;
    knots.push_back(*q);
  }
  return knots;
}

// Paths to the target, best first; empty after a failure that is noted.
std::vector<JointPath> find_paths(Planner& planner, std::size_t index, const RobotState& state) {
  const Pose target = target_pose(planner, index);
  const Vec3 p = target.translation();
  const std::string where =
      text("(%.3f, %.3f, %.3f) m in the robot's base frame, %.3f m from the base", p.x(), p.y(), p.z(), p.norm());
  if (planner.elements[index].is_straight) {
    const auto difference = pose_difference(current_pose(planner, state.q), target);
    const double knots =
        std::max(difference.head<3>().norm() / KNOT_DISTANCE, difference.tail<3>().norm() / KNOT_ANGLE);
    const int n = std::max(8, int(std::ceil(knots)));
    const std::vector<VectorXd> line = follow_line(planner, state.q, target, n);
    if (int(line.size()) == n + 1) {
      Eigen::MatrixXd matrix(n + 1, state.q.size());
      for (int k = 0; k <= n; ++k) matrix.row(k) = line[k];
      return {JointPath(matrix)};
    }
    fail(planner, index,
         "the tool's straight line to " + where +
             text(", leaves what the joints allow after %.0f %% of its length", 100.0 * double(line.size() - 1) / n) +
             "; move the target, or let the tool go on a line that is not straight");
    return {};
  }
  InverseKinematics search = settings();
  search.n_solutions = CANDIDATES;
  std::vector<JointPath> paths;
  for (VectorXd q :
       reach_pose(planner.model, planner.setup.tool_link, planner.setup.flange_to_tool, target, state.q, search)) {
    // the elbow of a redundant arm is free: take it as near to where the arm is as it goes
    InverseKinematics nearer = settings();
    nearer.max_iterations = 300;
    nearer.posture = state.q;
    nearer.posture_gain = 0.2;
    const auto better =
        follow_pose(planner.model, planner.setup.tool_link, planner.setup.flange_to_tool, target, q, nearer);
    if (better && (*better - state.q).norm() < (q - state.q).norm()) q = *better;
    Eigen::MatrixXd knots(2, q.size());
    knots << state.q.transpose(), q.transpose();
    paths.emplace_back(knots);
  }
  if (paths.empty())
    fail(planner, index,
         "its target at " + where + ", cannot be reached within the joint limits; move it or the robot");
  return paths;
}

// Number of steps for an element that needs `needed` seconds, or 0 after a failure that is noted.
int choose_steps(Planner& planner, std::size_t index, double needed) {
  const double wanted = planner.elements[index].duration;
  if (!std::isfinite(needed)) {
    fail(planner, index,
         "a joint would have to move where its velocity limit is zero, next to its end; move the target");
    return 0;
  }
  if (wanted > 0 && wanted < needed) {
    fail(planner, index,
         text("its duration of %.3f s is shorter than the %.3f s that the limits of velocity and "
              "acceleration ask for; give more time",
              wanted, needed));
    return 0;
  }
  return std::max(1, steps_for(std::max(wanted, needed), planner.setup.time_step));
}

bool plan_from(Planner& planner, std::size_t index, const RobotState& state);

bool take(Planner& planner, std::size_t index, const Rows& motion, const RobotState& end) {
  const Rows pause = repeated(planner, end, steps_for(planner.setup.rest, planner.setup.time_step));
  Rows both(motion.rows() + pause.rows(), motion.cols());
  both << motion, pause;
  planner.rows.resize(index);
  planner.rows.push_back(both);
  return plan_from(planner, index + 1, end);
}

bool plan_gripper(Planner& planner, std::size_t index, const RobotState& state) {
  RobotState end = state;
  end.gripper = planner.elements[index].gripper;
  const double way = std::abs(end.gripper - state.gripper);
  // the largest s' and s'' of the time law are 15/8 and 10/sqrt(3)
  const double needed = std::max(1.875 * way / planner.setup.gripper_speed,
                                 std::sqrt(10 / std::sqrt(3.0) * way / planner.setup.gripper_acceleration));
  const int n = choose_steps(planner, index, needed);
  if (n == 0) return false;
  Rows motion = repeated(planner, state, n);
  for (int k = 0; k < n; ++k)
    motion.row(k)
        .tail(planner.setup.n_gripper_joints)
        .setConstant(state.gripper + (end.gripper - state.gripper) * smoothstep(double(k + 1) / n).value);
  return take(planner, index, motion, end);
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
    const int n = choose_steps(planner, index, needed);
    if (n == 0) continue;
    Rows motion = repeated(planner, state, n);
    for (int k = 0; k < n; ++k) motion.row(k).head(state.q.size()) = path.at(smoothstep(double(k + 1) / n).value).q;
    if (take(planner, index, motion, {path.end(), state.gripper})) return true;
  }
  return false;
}

// Plans element `index` and all after it, going back to another configuration where the rest turns out impossible.
bool plan_from(Planner& planner, std::size_t index, const RobotState& state) {
  if (index == planner.elements.size()) return true;
  using Type = MotionElement::Type;
  switch (planner.elements[index].type) {
    case Type::wait:
      return take(planner, index,
                  repeated(planner, state, steps_for(planner.elements[index].duration, planner.setup.time_step)),
                  state);
    case Type::close:
    case Type::open:
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
    throw UsageError("robot '" + model.name + "' has " + std::to_string(model.actuated.size()) +
                     " moving joints but its start configuration has " + std::to_string(setup.q_start.size()) +
                     "; give one position for each");
}

}  // namespace

JointTrajectory plan_motion(const RobotModel& model, const MotionSetup& setup,
                            std::span<const MotionElement> elements) {
  check(model, setup);
  Planner planner{model, setup, elements, {}, {}, 0, {}, 0};
  for (const int joint : model.actuated) planner.joints.push_back(model.joints[joint]);
  if (!plan_from(planner, 0, {setup.q_start, setup.gripper_start})) throw UsageError(planner.failure);

  JointTrajectory trajectory;
  trajectory.time_step = setup.time_step;
  Eigen::Index n_steps = 0;
  for (const Rows& rows : planner.rows) n_steps += rows.rows();
  trajectory.q.resize(n_steps, setup.q_start.size() + setup.n_gripper_joints);
  Eigen::Index next = 0;
  for (std::size_t i = 0; i < planner.rows.size(); ++i) {
    trajectory.q.middleRows(next, planner.rows[i].rows()) = planner.rows[i];
    trajectory.element.insert(trajectory.element.end(), std::size_t(planner.rows[i].rows()), int(i));
    next += planner.rows[i].rows();
  }
  return trajectory;
}

}  // namespace pvg
