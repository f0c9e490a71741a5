#include "host/load/build_scene.hpp"
#include "host/load/recording/robot_set.hpp"
#include "host/load/task_file.hpp"

namespace pvg {

SceneRun load_robots_alone(const std::filesystem::path& file) {
  Task task = load_task(file);
  task.objects.clear();
  task.joints.clear();
  task.cloths.clear();
  task.pair_friction.clear();
  task.pair_restitution.clear();
  task.variations.clear();
  task.background = {};
  task.lights.clear();
  task.cameras.clear();
  const auto alone = [](RobotSection& robot, std::optional<GripperSection>& gripper) {
    robot.collision_links.emplace();
    if (gripper) gripper->is_rigid = true;
  };
  alone(task.robot, task.gripper);
  for (RobotCell& cell : task.more_robots) alone(cell.robot, cell.gripper);
  SceneRun run;
  run.scene = build_scene_at_middle(task).scene;
  for (const Joint& joint : run.scene.joints)
    if (is_driven(joint)) run.targets.push_back({{0}, {joint.initial}});
  return run;
}

}  // namespace pvg
