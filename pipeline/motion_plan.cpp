#include "pipeline/motion_plan.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <sstream>

#include "host/base/error.hpp"
#include "host/io/states_file.hpp"
#include "host/robot/plan_motion.hpp"
#include "host/robot/way_search.hpp"

namespace pvg {
namespace {

// The scene as robot `own` meets it at the start, all but the cloths: what its flange carries, and what stands in its
// way.
WaySearch search_in(const TaskScene& built, std::size_t own, const RobotCell& cell, const RobotModel& model) {
  const Scene& scene = built.scene;
  const BuiltRobot& robot = built.robots[own];
  const Pose to_base = cell.robot.base.inverse();
  const int link = model.link(cell.robot.flange);
  const VectorXd home = Eigen::Map<const VectorXd>(cell.robot.home.data(), Eigen::Index(cell.robot.home.size()));
  const Pose to_link = link_poses(model, home)[std::size_t(link)].inverse() * to_base;
  const auto holds = [](const std::vector<int>& list, int body) {
    return std::find(list.begin(), list.end(), body) != list.end();
  };
  std::vector<Obstacle> carried, obstacles;
  for (int b = 0; b < int(scene.rigid_bodies.size()); ++b) {
    const RigidBody& body = scene.rigid_bodies[std::size_t(b)];
    if (body.collision.triangles.empty() || holds(robot.arm_bodies, b)) continue;
    const bool is_carried = holds(robot.gripper_bodies, b) || holds(robot.rigid_fingers, b);
    (is_carried ? carried : obstacles)
        .push_back({body.name, body.collision, (is_carried ? to_link : to_base) * body.pose});
  }
  for (int b = 0; b < int(scene.soft_bodies.size()); ++b) {
    const SoftBody& body = scene.soft_bodies[std::size_t(b)];
    const bool is_carried = holds(robot.soft_fingers, b);
    (is_carried ? carried : obstacles)
        .push_back({body.name, {body.mesh.points, body.mesh.surface}, (is_carried ? to_link : to_base) * body.pose});
  }
  return WaySearch(model, link, carried, obstacles);
}

MotionSetup motion_setup(const RobotCell& cell, const BuiltRobot& robot, const Scene& scene, const RobotModel& model) {
  MotionSetup setup;
  setup.base = cell.robot.base;
  setup.tool_link = model.link(cell.robot.flange);
  setup.flange_to_tool = robot.flange_to_tool;
  setup.q_start = Eigen::Map<const VectorXd>(cell.robot.home.data(), Eigen::Index(cell.robot.home.size()));
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

// Which steps are those of each element that moves a gripper. element: [n_steps] of elements, groups by their first
std::vector<Grip> grips_of(const std::vector<MotionElement>& elements, const std::vector<int>& element,
                           const std::vector<RobotCell>& robots) {
  using Type = MotionElement::Type;
  std::vector<double> position;
  for (const RobotCell& robot : robots) position.push_back(robot.gripper ? robot.gripper->open : 0);
  std::vector<Grip> grips;
  std::size_t group = 0;
  for (std::size_t i = 0; i < elements.size(); ++i) {
    if (!elements[i].is_with_previous) group = i;
    if (elements[i].type != Type::close && elements[i].type != Type::open) continue;
    double& at = position[std::size_t(elements[i].robot)];
    const auto first = std::find(element.begin(), element.end(), int(group));
    const auto last = std::find_if(first, element.end(), [&](int e) { return e != int(group); });
    grips.push_back({elements[i].robot, std::size_t(first - element.begin()), std::size_t(last - element.begin()), at,
                     elements[i].gripper, elements[i].force});
    at = elements[i].gripper;
  }
  return grips;
}

}  // namespace

std::size_t steps_per_frame(double frames_per_second, double time_step) {
  const double steps = 1 / (frames_per_second * time_step);
  const double whole = std::round(steps);
  if (!(whole >= 1) || !(std::abs(steps - whole) < 1e-6 * whole)) {
    std::ostringstream message;
    message << frames_per_second << " frames per second do not fall on steps of " << time_step
            << " s: choose a rate (--fps or render/frames_per_second) that divides " << 1 / time_step;
    throw UsageError(message.str());
  }
  return std::size_t(whole);
}

MotionPlan plan_episode(const Task& task, const TaskScene& built) {
  MotionPlan plan;
  plan.steps_per_frame = steps_per_frame(task.render.frames_per_second, built.scene.solver.time_step);
  const std::vector<RobotCell> robots = robots_of(task);
  std::vector<RobotModel> models;
  std::vector<MotionSetup> setups;
  for (std::size_t r = 0; r < robots.size(); ++r) {
    models.push_back(load_urdf(robots[r].robot.urdf));
    setups.push_back(motion_setup(robots[r], built.robots[r], built.scene, models.back()));
    const bool searches = std::any_of(task.motion.begin(), task.motion.end(), [&](const MotionElement& element) {
      return element.robot == int(r) && element.avoids_obstacles;
    });
    if (searches)
      setups.back().search_way = [search = std::make_shared<WaySearch>(search_in(built, r, robots[r], models.back()))](
                                     const VectorXd& from, const VectorXd& to) { return search->search(from, to); };
  }
  std::vector<PlannedRobot> planned;
  for (std::size_t r = 0; r < robots.size(); ++r) planned.push_back({models[r], setups[r]});
  const std::vector<JointTrajectory> trajectories = plan_motion(planned, task.motion);
  const std::vector<int>& element = trajectories.front().element;
  if (element.empty()) throw UsageError(task.file.string() + ": the task's motion has no step");
  const std::vector<Column> columns = columns_of_driven(built);
  // the last frame is filled up by standing still
  const std::size_t n = element.size(), frames = (n + plan.steps_per_frame - 1) / plan.steps_per_frame;
  for (std::size_t step = 0; step < frames * plan.steps_per_frame; ++step) {
    const std::size_t row = std::min(step, n - 1);
    std::vector<double>& target = plan.targets.emplace_back();
    for (const Column& at : columns) target.push_back(trajectories[at.robot].q(Eigen::Index(row), at.column));
    plan.element.push_back(element.at(row));
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
