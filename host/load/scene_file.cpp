#include "host/load/scene_file.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

#include "host/base/error.hpp"
#include "host/load/build_parts.hpp"
#include "host/load/build_scene.hpp"
#include "host/load/read_bodies.hpp"
#include "host/load/read_sections.hpp"
#include "host/robot/imported_scene.hpp"

namespace pvg {
namespace {

// `added` behind what the scene has, its indices moved by it
void append(PhysicalScene& scene, const PhysicalScene& added) {
  const int first_rigid = int(scene.rigid_bodies.size()), first_soft = int(scene.soft_bodies.size());
  const auto append_list = [](auto& to, const auto& from) { to.insert(to.end(), from.begin(), from.end()); };
  append_list(scene.rigid_bodies, added.rigid_bodies);
  append_list(scene.soft_bodies, added.soft_bodies);
  for (Joint joint : added.joints) {
    joint.parent += first_rigid;
    joint.child += first_rigid;
    scene.joints.push_back(joint);
  }
  for (Stitch stitch : added.stitches) {
    stitch.rigid += first_rigid;
    if (stitch.soft >= 0) stitch.soft += first_soft;
    scene.stitches.push_back(stitch);
  }
  for (const auto& [first, second] : added.noncolliding_rigid_bodies)
    scene.noncolliding_rigid_bodies.push_back({first + first_rigid, second + first_rigid});
}

void add_body_visuals(Scene& scene, const BodyVisuals& body, int first_rigid, int first_soft) {
  Visual visual;
  if (body.rigid >= 0) visual.rigid = first_rigid + body.rigid;
  if (body.soft >= 0) visual.soft = first_soft + body.soft;
  visual.name = visual.part = body.rigid >= 0 ? scene.rigid_bodies[std::size_t(visual.rigid)].name
                                              : scene.soft_bodies[std::size_t(visual.soft)].name;
  add_visuals(scene, body.visuals, visual);
  if (body.display.width > 0) add_display(scene, body.display, visual.rigid, 1);
}

void check_last_robot_point(YamlSection& section, SceneRobot& robot) {
  RobotPathPoint& point = robot.path.back();
  if (robot.path.size() > 1 && !(point.time > robot.path.end()[-2].time)) section.fail("time", "must ascend");
  if (point.joints.size() != robot.cell.robot.home.size())
    section.fail("joints", "must hold as many numbers as the robot's `home`");
  if (point.gripper && !robot.cell.gripper) section.fail("gripper", "is of no use: the robot carries none");
  if (!point.gripper && robot.cell.gripper) point.gripper = robot.cell.gripper->open;
}

TargetTable targets_along(const RobotPath& path, const std::function<double(const RobotPathPoint&)>& value) {
  TargetTable table;
  for (const RobotPathPoint& point : path) {
    table.time.push_back(point.time);
    table.value.push_back(value(point));
  }
  return table;
}

// Of all driven joints of the robots: their paths, or where they start.
std::vector<TargetTable> robot_targets(const TaskScene& built, const std::vector<RobotPath>& paths) {
  const std::size_t n_before = built.robots.size() - paths.size();  // the one of the section `robot`
  const std::vector<Joint>& joints = built.scene.joints;
  std::vector<TargetTable> of_joint;
  for (const Joint& joint : joints) of_joint.push_back({{0}, {joint.initial}});
  for (std::size_t r = 0; r < paths.size(); ++r) {
    if (paths[r].empty()) continue;
    const BuiltRobot& robot = built.robots[r + n_before];
    for (std::size_t k = 0; k < robot.arm.size(); ++k)
      of_joint[std::size_t(robot.arm[k])] = targets_along(paths[r], [k](const auto& point) { return point.joints[k]; });
    for (const int joint : robot.gripper)
      of_joint[std::size_t(joint)] = targets_along(paths[r], [](const auto& point) { return *point.gripper; });
  }
  std::vector<TargetTable> targets;
  for (std::size_t j = 0; j < joints.size(); ++j)
    if (is_driven(joints[j])) targets.push_back(of_joint[j]);
  return targets;
}

}  // namespace

double TargetTable::at(double t) const {
  const std::size_t after = std::size_t(std::upper_bound(time.begin(), time.end(), t) - time.begin());
  if (after == 0) return value.front();
  if (after == time.size()) return value.back();
  const double share = (t - time[after - 1]) / (time[after] - time[after - 1]);
  return value[after - 1] + share * (value[after] - value[after - 1]);
}

const Fields<SceneFile>& scene_file_fields() {
  static const Fields<SceneFile> FIELDS =
      Fields<SceneFile>()
          .number(
              "gravity", [](auto& file) -> auto& { return file.added.gravity; }, Unit::acceleration, -1e6, 1e6,
              "acts on all bodies")
          .flag(
              "separate", [](auto& file) -> auto& { return file.added.separates_start; },
              "moves free rigid bodies apart that intersect at the start, never downward, and prints the moves")
          .number("duration", &SceneFile::duration, Unit::time, 0, 1e5, "of the simulation");
  return FIELDS;
}

const Fields<SceneRobot>& scene_robot_fields() {
  using P = RobotPathPoint;
  static const Fields<P> POINT =
      Fields<P>()
          .number("time", &P::time, Unit::time, 0, 1e6, "ascending; straight lines in joint space between")
          .required()
          .number("joints", &P::joints, Unit::angle, -1e3, 1e3, "a number per joint of the arm")
          .required()
          .number("gripper", &P::gripper, Unit::length, 0, 1, "position of the gripper's joints")
          .otherwise("`open` of the gripper");
  static const Fields<SceneRobot> FIELDS =
      Fields<SceneRobot>()
          .include(robot_cell_fields(), &SceneRobot::cell)
          .list("path", &SceneRobot::path, POINT, "where its drives are told to be; none: at `home`",
                check_last_robot_point);
  return FIELDS;
}

namespace {

void refuse_task(const YamlSection& root) {
  for (const char* key : {"motion", "success", "failure", "vary", "record"})
    if (root.holds(key))
      root.fail(key,
                "is a key of tasks, but a scene is needed here; give this file to `phyvisgen generate`, or leave the "
                "key out");
}

SceneFile read_scene_file(YamlSection root) {
  refuse_task(root);
  SceneFile file;
  file.task = read_scene_sections(root, LARGEST_SCENE_TIME_STEP);
  scene_file_fields().read(root, file);
  for (const YamlSection& section : root.sections("robots")) {
    SceneRobot robot = read_all(scene_robot_fields(), section);
    add_robot_cell(section, std::move(robot.cell), file.task);
    file.paths.push_back(std::move(robot.path));
  }
  for (YamlSection& section : root.sections("bodies")) read_body(section, file);
  for (YamlSection& section : root.sections("joints")) read_joint(section, file);
  for (YamlSection& section : root.sections("stitches")) read_stitch(section, file);
  for (YamlSection& section : root.sections("noncolliding")) read_noncolliding(section, file);
  for (const RobotCell& cell : robots_of(file.task))
    if (cell.robot.feeds_friction_forward)
      root.fail(cell.name.empty() ? "robot" : "robots",
                "has `feedforward: friction`, which is for the planned motion of a task; leave it out");
  root.done();
  std::vector<std::string> bodies;
  for (const RigidBody& body : file.added.rigid_bodies) bodies.push_back(body.name);
  for (const SoftBody& body : file.added.soft_bodies) bodies.push_back(body.name);
  check_names(root, file.task, bodies);
  return file;
}

}  // namespace

SceneFile load_scene_file(const std::filesystem::path& path) {
  return read_scene_file(is_robot_description(path) ? YamlSection::translated(imported_scene(path), path)
                                                    : YamlSection::load(path, "scene file"));
}

std::size_t SceneRun::n_steps() const { return std::size_t(std::llround(duration / scene.solver.time_step)); }

std::vector<double> SceneRun::targets_at(double time) const {
  std::vector<double> values;
  for (const TargetTable& table : targets) values.push_back(table.at(time));
  return values;
}

namespace {

SceneRun run_of(const SceneFile& file, const std::filesystem::path& path) {
  SceneRun run;
  const TaskScene built = build_scene_at_middle(file.task);
  run.scene = built.scene;
  run.targets = robot_targets(built, file.paths);
  const int first_rigid = int(run.scene.rigid_bodies.size()), first_soft = int(run.scene.soft_bodies.size());
  append(run.scene, file.added);
  try {
    for (const BodyVisuals& body : file.visuals) add_body_visuals(run.scene, body, first_rigid, first_soft);
    for (const auto& [rigid, surface] : file.passing_surfaces)
      run.scene.passing_surfaces.push_back({first_rigid + rigid, surface});
  } catch (const UsageError& error) {
    throw UsageError(path.string() + ": " + error.what());
  }
  run.scene.gravity = file.added.gravity;
  run.scene.separates_start = file.added.separates_start;
  try {
    check_effects(run.scene);
  } catch (const UsageError& error) {
    throw UsageError(path.string() + ": " + error.what());
  }
  run.targets.insert(run.targets.end(), file.targets.begin(), file.targets.end());
  run.duration = file.duration;
  run.render = file.task.render;
  return run;
}

}  // namespace

SceneRun load_scene_run(const std::filesystem::path& path) {
  SceneRun run = run_of(load_scene_file(path), path);
  run.configuration = scene_text(path);
  return run;
}

Scene load_changed_scene(const std::filesystem::path& file, const std::string& text) {
  return run_of(read_scene_file(YamlSection::translated(text, file)), file).scene;
}

Scene load_scene(const std::filesystem::path& file) { return load_scene_run(file).scene; }

}  // namespace pvg
