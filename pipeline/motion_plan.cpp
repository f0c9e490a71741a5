#include "pipeline/motion_plan.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "host/base/error.hpp"
#include "host/io/states_file.hpp"
#include "host/robot/plan_motion.hpp"

namespace pvg {
namespace {

MotionSetup motion_setup(const Task& task, const TaskScene& built, const RobotModel& model) {
  MotionSetup setup;
  setup.base = task.robot.base;
  setup.tool_link = model.link(task.robot.flange);
  setup.flange_to_tool = built.flange_to_tool;
  setup.q_start = Eigen::Map<const VectorXd>(task.robot.home.data(), Eigen::Index(task.robot.home.size()));
  setup.time_step = built.scene.solver.time_step;
  if (task.gripper) {
    setup.n_gripper_joints = int(built.gripper_joints.size());
    setup.gripper_start = task.gripper->open;
  }
  for (const RigidBody& body : built.scene.rigid_bodies) setup.objects[body.name] = body.pose;
  return setup;
}

// Column of the trajectory (arm, then gripper) of each joint with a drive.
std::vector<Eigen::Index> columns_of_driven(const TaskScene& built) {
  std::vector<int> planned = built.arm_joints;
  planned.insert(planned.end(), built.gripper_joints.begin(), built.gripper_joints.end());
  std::vector<Eigen::Index> columns;
  for (const std::size_t joint : driven_joints(built.scene)) {
    const auto found = std::find(planned.begin(), planned.end(), int(joint));
    if (found == planned.end())
      throw UsageError("joint " + built.scene.joints[joint].name + " has a drive, but no motion reaches it");
    columns.push_back(found - planned.begin());
  }
  return columns;
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
  const RobotModel model = load_urdf(task.robot.urdf);
  const JointTrajectory trajectory = plan_motion(model, motion_setup(task, built, model), task.motion);
  if (trajectory.q.rows() == 0) throw UsageError(task.file.string() + ": the task's motion has no step");
  const std::vector<Eigen::Index> columns = columns_of_driven(built);
  // the last frame is filled up by standing still
  const std::size_t n = std::size_t(trajectory.q.rows()),
                    frames = (n + plan.steps_per_frame - 1) / plan.steps_per_frame;
  for (std::size_t step = 0; step < frames * plan.steps_per_frame; ++step) {
    const std::size_t row = std::min(step, n - 1);
    std::vector<double>& target = plan.targets.emplace_back();
    for (const Eigen::Index column : columns) target.push_back(trajectory.q(Eigen::Index(row), column));
    plan.element.push_back(trajectory.element.at(row));
  }
  return plan;
}

std::string element_name(const MotionElement& element) {
  using Type = MotionElement::Type;
  switch (element.type) {
    case Type::approach:
      return "approach";
    case Type::close:
      return "close";
    case Type::lift:
      return "lift";
    case Type::carry:
      return "carry";
    case Type::lower:
      return "lower";
    case Type::open:
      return "open";
    case Type::retreat:
      return "retreat";
    case Type::wait:
      return "wait";
  }
  return "?";
}

}  // namespace pvg
