#include "pipeline/episode/motion_plan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <span>
#include <sstream>

#include "host/base/error.hpp"
#include "host/dataset/states_file.hpp"
#include "host/geometry/inside.hpp"
#include "host/robot/disturbance.hpp"
#include "host/robot/friction_feedforward.hpp"
#include "host/robot/motion_timing.hpp"
#include "host/robot/path_planner.hpp"
#include "host/robot/plan_motion.hpp"
#include "host/robot/robots_apart.hpp"

namespace pvg {
namespace {

// What is there at the start, all but the cloths and the arm: what the robot's flange carries, and the rest.
struct Surroundings {
  std::vector<Obstacle> carried, obstacles;
};

Surroundings surroundings_of(const TaskScene& built, std::size_t own, const RobotCell& cell, const RobotModel& model) {
  const Scene& scene = built.scene;
  const BuiltRobot& robot = built.robots[own];
  const Pose to_base = cell.robot.base.inverse();
  const VectorXd home = Eigen::Map<const VectorXd>(cell.robot.home.data(), Eigen::Index(cell.robot.home.size()));
  const Pose to_link = link_poses(model, home)[std::size_t(model.link(cell.robot.flange))].inverse() * to_base;
  const auto holds = [](const std::vector<int>& list, int body) {
    return std::find(list.begin(), list.end(), body) != list.end();
  };
  Surroundings found;
  const auto add = [&](bool is_carried, const std::string& name, const TriangleMesh& mesh, const Pose& pose) {
    (is_carried ? found.carried : found.obstacles).push_back({name, mesh, (is_carried ? to_link : to_base) * pose});
  };
  for (int b = 0; b < int(scene.rigid_bodies.size()); ++b) {
    const RigidBody& body = scene.rigid_bodies[std::size_t(b)];
    if (body.collision.triangles.empty() || holds(robot.arm_bodies, b)) continue;
    add(holds(robot.gripper_bodies, b) || holds(robot.rigid_fingers, b), body.name, body.collision, body.pose);
  }
  for (int b = 0; b < int(scene.soft_bodies.size()); ++b) {
    const SoftBody& body = scene.soft_bodies[std::size_t(b)];
    add(holds(robot.soft_fingers, b), body.name, {body.mesh.points, body.mesh.surface}, body.pose);
  }
  return found;
}

MotionSetup motion_setup(const RobotCell& cell, const BuiltRobot& robot, const Scene& scene, const RobotModel& model) {
  MotionSetup setup;
  setup.base = cell.robot.base;
  setup.tool_link = model.link(cell.robot.flange);
  setup.flange_to_tool = robot.flange_to_tool;
  setup.q_start = Eigen::Map<const VectorXd>(cell.robot.home.data(), Eigen::Index(cell.robot.home.size()));
  setup.posture = Eigen::Map<const VectorXd>(cell.robot.posture.data(), Eigen::Index(cell.robot.posture.size()));
  setup.time_step = scene.solver.time_step;
  if (cell.gripper) {
    setup.n_gripper_joints = int(robot.gripper.size());
    setup.gripper_start = cell.gripper->open;
  }
  for (const RigidBody& body : scene.rigid_bodies) setup.objects[body.name] = body.pose;
  for (const Cloth& cloth : scene.cloths) setup.objects[cloth.name] = cloth.pose;
  return setup;
}

// Of each joint with a drive: its robot and its column in that robot's trajectory (arm, then gripper).
struct Column {
  std::size_t robot = 0;
  Eigen::Index column = 0;
};
std::vector<Column> columns_of_driven(const TaskScene& built) {
  std::vector<Column> columns;
  for (const std::size_t joint : driven_joints(built.scene)) {
    bool is_planned = false;
    for (std::size_t r = 0; r < built.robots.size() && !is_planned; ++r) {
      std::vector<int> planned = built.robots[r].arm;
      planned.insert(planned.end(), built.robots[r].gripper.begin(), built.robots[r].gripper.end());
      const auto found = std::find(planned.begin(), planned.end(), int(joint));
      is_planned = found != planned.end();
      if (is_planned) columns.push_back({r, found - planned.begin()});
    }
    if (!is_planned)
      throw UsageError("joint " + built.scene.joints[joint].name + " has a drive, but no motion reaches it");
  }
  return columns;
}

// Adds to the targets of arms that feed friction forward what they must lead.   targets: [n_steps][n_driven]
void feed_friction_forward(const TaskScene& built, const std::vector<RobotCell>& robots,
                           const std::vector<Column>& columns, std::vector<std::vector<double>>& targets) {
  const std::vector<std::size_t> driven = driven_joints(built.scene);
  for (std::size_t c = 0; c < columns.size(); ++c) {
    const RobotSection& robot = robots[columns[c].robot].robot;
    const std::size_t joint = std::size_t(columns[c].column);
    if (!robot.feeds_friction_forward || joint >= robot.home.size()) continue;  // the gripper's joints come after
    std::vector<double> q;
    for (const std::vector<double>& target : targets) q.push_back(target[c]);
    const std::vector<double> lead = friction_lead(built.scene.joints[driven[c]], built.scene.effects,
                                                   robot.home[joint], q, built.scene.solver.time_step);
    for (std::size_t step = 0; step < targets.size(); ++step) targets[step][c] += lead[step];
  }
}

// In which steps of the plan a robot's hand may be pushed: all it does in them is among the elements named.
std::vector<bool> disturbed_steps(const std::vector<MotionElement>& elements, const std::vector<int>& element,
                                  int robot, const std::vector<std::string>& during) {
  const auto may = [&](int first) {
    bool moves = false;
    for (std::size_t i = std::size_t(first); i < elements.size(); ++i) {
      if (i > std::size_t(first) && !elements[i].is_with_previous) break;
      if (elements[i].robot != robot) continue;
      if (std::find(during.begin(), during.end(), kind_of(elements[i]).name) == during.end()) return false;
      moves = true;
    }
    return moves;
  };
  std::vector<bool> steps;
  for (const int first : element) steps.push_back(may(first));
  return steps;
}

// What pushes each target, of all hands.   -> [n_steps][n_driven]
std::vector<std::vector<double>> disturb(const Task& task, const TaskScene& built,
                                         const std::vector<PlannedRobot>& planned,
                                         const std::vector<JointTrajectory>& trajectories,
                                         const std::vector<Column>& columns) {
  std::vector<Eigen::MatrixXd> shifts;
  for (std::size_t r = 0; r < planned.size(); ++r) {
    const JointTrajectory& trajectory = trajectories[r];
    const MotionSetup& setup = planned[r].setup;
    Eigen::MatrixXd& shift = shifts.emplace_back(Eigen::MatrixXd::Zero(trajectory.q.rows(), trajectory.q.cols()));
    std::vector<PushAside> pushes;
    std::vector<std::string> during;
    for (const Disturbance& drawn : built.disturbances) {
      if (drawn.of != hand_name(built.robots[r].name)) continue;
      pushes.push_back({drawn.when, drawn.duration, drawn.by, drawn.turn});
      during = drawn.during;  // the same of all
    }
    if (pushes.empty()) continue;
    const std::vector<bool> may = disturbed_steps(task.motion, trajectory.element, int(r), during);
    shift.leftCols(setup.q_start.size()) = pushed_aside({planned[r].model, setup.tool_link, setup.flange_to_tool},
                                                        trajectory.q, may, pushes, trajectory.time_step);
  }
  std::vector<std::vector<double>> rows(std::size_t(shifts.front().rows()));
  for (std::size_t step = 0; step < rows.size(); ++step)
    for (const Column& at : columns) rows[step].push_back(shifts[at.robot](Eigen::Index(step), at.column));
  return rows;
}

// Which steps are those of each element that moves a gripper. element: [n_steps] of elements, groups by their first
std::vector<Grip> grips_of(const std::vector<MotionElement>& elements, const std::vector<int>& element,
                           const std::vector<RobotCell>& robots) {
  std::vector<double> position;
  for (const RobotCell& robot : robots) position.push_back(robot.gripper ? robot.gripper->open : 0);
  std::vector<Grip> grips;
  std::size_t group = 0;
  for (std::size_t i = 0; i < elements.size(); ++i) {
    if (!elements[i].is_with_previous) group = i;
    if (kind_of(elements[i]).given != GivenMotion::gripper_position) continue;
    double& at = position[std::size_t(elements[i].robot)];
    const auto first = std::find(element.begin(), element.end(), int(group));
    const auto last = std::find_if(first, element.end(), [&](int e) { return e != int(group); });
    grips.push_back({elements[i].robot, std::size_t(first - element.begin()), std::size_t(last - element.begin()), at,
                     elements[i].gripper, elements[i].force});
    at = elements[i].gripper;
  }
  return grips;
}

// Refuses a motion in which an arm comes near to itself or to another one.
void check_apart(const Task& task, const std::vector<RobotCell>& robots, const std::vector<PlannedRobot>& planned,
                 const std::vector<Surroundings>& surroundings, const std::vector<JointTrajectory>& trajectories) {
  std::vector<RobotShape> shapes;
  std::vector<Eigen::MatrixXd> q;
  for (std::size_t r = 0; r < robots.size(); ++r) {
    const MotionSetup& setup = planned[r].setup;
    shapes.push_back({robots[r].name, planned[r].model, setup.base, setup.tool_link, surroundings[r].carried});
    q.push_back(trajectories[r].q);
  }
  const auto found = first_encounter(shapes, q);
  if (!found) return;
  const auto element = std::size_t(trajectories.front().element[found->step]);
  throw UsageError(fmt::format(
      "{}: `{}` and `{}` would come closer than 10 mm, {:g} s after the start, in motion[{}] ({}); move its target, "
      "the "
      "robots' bases or their `home`",
      task.file.string(), found->first, found->second, double(found->step + 1) * trajectories.front().time_step,
      element, kind_of(task.motion[element]).name));
}

constexpr double DEEPEST = 0.01;  // of a tool in a fixed body, as near as arms may come to each other [m]

bool is_of_robot(const TaskScene& built, int body) {
  const auto holds = [body](const std::vector<int>& list) {
    return std::find(list.begin(), list.end(), body) != list.end();
  };
  return std::any_of(built.robots.begin(), built.robots.end(), [&](const BuiltRobot& robot) {
    return holds(robot.arm_bodies) || holds(robot.gripper_bodies) || holds(robot.rigid_fingers);
  });
}

// The element of this robot in the group that begins with `first`; nothing: its tool does not move in it.
std::optional<std::size_t> moving_element(std::span<const MotionElement> motion, std::size_t first, int robot) {
  for (std::size_t i = first; i < motion.size() && (i == first || motion[i].is_with_previous); ++i) {
    const GivenMotion given = kind_of(motion[i]).given;
    if (motion[i].robot == robot && given != GivenMotion::gripper_position && given != GivenMotion::duration) return i;
  }
  return std::nullopt;
}

// way: of the tool, to its target at the end [m]
void refuse_way(const TaskScene& built, std::span<const MotionElement> motion, std::size_t element,
                std::span<const Vec3> way) {
  for (int b = 0; b < int(built.scene.rigid_bodies.size()); ++b) {
    const RigidBody& body = built.scene.rigid_bodies[std::size_t(b)];
    if (!body.is_fixed || body.collision.triangles.empty() || is_of_robot(built, b)) continue;
    std::vector<Vec3> in_body;
    for (const Vec3& p : way) in_body.push_back(body.pose.inverse() * p);
    const double depth = depth_inside(body.collision, in_body.back());
    if (depth > DEEPEST)
      throw UsageError(describe_element(motion, element) +
                       fmt::format(": its target is {:.0f} mm inside of `{}`, which is fixed; move one of the two",
                                   1e3 * depth, body.name));
    if (passes_through(body.collision, in_body, DEEPEST))
      throw UsageError(describe_element(motion, element) +
                       fmt::format(": the tool would pass through `{}`, which is fixed, on its way to the target; move "
                                   "the target, or lead around the body by elements before this one",
                                   body.name));
  }
}

// Contact would hold the hand against a body that stands fast for as long as the motion lasts, at many times the cost
// of a step: refuses a motion in which a tool ends deep inside of one, or passes through it.
void refuse_buried_targets(const TaskScene& built, std::span<const MotionElement> motion,
                           std::span<const PlannedRobot> robots, std::span<const JointTrajectory> trajectories) {
  for (std::size_t r = 0; r < robots.size(); ++r) {
    const auto& [model, setup] = robots[r];
    const std::vector<int>& group = trajectories[r].element;
    const auto tool_at = [&](const VectorXd& q) -> Vec3 {
      return (setup.base * tool_pose(model, q, setup.tool_link, setup.flange_to_tool)).translation();
    };
    std::vector<Vec3> way = {tool_at(setup.q_start)};
    for (std::size_t step = 0; step < group.size(); ++step) {
      way.push_back(tool_at(trajectories[r].q.row(Eigen::Index(step)).head(setup.q_start.size())));
      if (step + 1 < group.size() && group[step + 1] == group[step]) continue;  // where the group ends
      const auto element = moving_element(motion, std::size_t(group[step]), int(r));
      if (element) refuse_way(built, motion, *element, way);
      way = {way.back()};
    }
  }
}

}  // namespace

std::size_t steps_per_frame(double frames_per_second, double time_step) {
  const double steps = 1 / (frames_per_second * time_step);
  const double whole = std::round(steps);
  if (!(whole >= 1) || !(std::abs(steps - whole) < 1e-6 * whole)) {
    throw UsageError(fmt::format(
        "{:g} frames per second do not fall on steps of {:g} s: choose a rate (--fps or render/frames_per_second) that "
        "divides {:g}",
        frames_per_second, time_step, 1 / time_step));
  }
  return std::size_t(whole);
}

MotionPlan plan_episode(const Task& task, const TaskScene& built) {
  MotionPlan plan;
  plan.steps_per_frame = steps_per_frame(task.render.frames_per_second, built.scene.solver.time_step);
  const std::vector<RobotCell> robots = robots_of(task);
  std::vector<RobotModel> models;
  std::vector<MotionSetup> setups;
  std::vector<Surroundings> surroundings;
  for (std::size_t r = 0; r < robots.size(); ++r) {
    models.push_back(load_urdf(robots[r].robot.urdf));
    surroundings.push_back(surroundings_of(built, r, robots[r], models.back()));
    setups.push_back(motion_setup(robots[r], built.robots[r], built.scene, models.back()));
    const bool searches = std::any_of(task.motion.begin(), task.motion.end(), [&](const MotionElement& element) {
      return element.robot == int(r) && element.avoids_obstacles;
    });
    if (searches)
      setups.back().plan_path = [planner =
                                     std::make_shared<PathPlanner>(models.back(), setups.back().tool_link,
                                                                   surroundings[r].carried, surroundings[r].obstacles)](
                                    const VectorXd& from, const VectorXd& to) { return planner->plan(from, to); };
  }
  std::vector<PlannedRobot> planned;
  for (std::size_t r = 0; r < robots.size(); ++r) planned.push_back({models[r], setups[r]});
  const std::vector<JointTrajectory> trajectories = plan_motion(planned, task.motion);
  const std::vector<int>& element = trajectories.front().element;
  if (element.empty()) throw UsageError(task.file.string() + ": the task's motion has no step");
  check_apart(task, robots, planned, surroundings, trajectories);
  refuse_buried_targets(built, task.motion, planned, trajectories);
  const std::vector<Column> columns = columns_of_driven(built);
  // the last frame is filled up by standing still
  const std::size_t n = element.size(), frames = (n + plan.steps_per_frame - 1) / plan.steps_per_frame;
  for (std::size_t step = 0; step < frames * plan.steps_per_frame; ++step) {
    const std::size_t row = std::min(step, n - 1);
    std::vector<double>& target = plan.targets.emplace_back();
    for (const Column& at : columns) target.push_back(trajectories[at.robot].q(Eigen::Index(row), at.column));
    plan.element.push_back(element.at(row));
  }
  feed_friction_forward(built, robots, columns, plan.targets);
  if (!built.disturbances.empty()) {
    plan.disturbance = disturb(task, built, planned, trajectories, columns);
    plan.disturbance.resize(plan.targets.size(), std::vector<double>(columns.size(), 0));
  }
  plan.grips = grips_of(task.motion, plan.element, robots);
  for (std::size_t r = 0; r < robots.size(); ++r) {
    std::vector<int>& own = plan.gripper_columns.emplace_back();
    for (std::size_t c = 0; c < columns.size(); ++c)
      if (columns[c].robot == r && columns[c].column >= Eigen::Index(built.robots[r].arm.size())) own.push_back(int(c));
    plan.gripper_joints.push_back(built.robots[r].gripper);
  }
  return plan;
}

}  // namespace pvg
