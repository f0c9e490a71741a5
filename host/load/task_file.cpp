#include "host/load/task_file.hpp"

#include <set>
#include <string>
#include <utility>
#include <vector>

#include "host/load/captured_room.hpp"
#include "host/load/read_sections.hpp"

namespace pvg {
namespace {

using Section = YamlSection;

template <class T>
void read_if_there(Section& root, const std::string& key, const Fields<T>& fields, T& value) {
  if (root.has(key)) value = read_all(fields, root.section(key));
}

bool is_cloth(const Task& task, const std::string& name) {
  return std::any_of(task.cloths.begin(), task.cloths.end(),
                     [&](const ClothSection& section) { return section.cloth.name == name; });
}

bool is_finger(const Task& task, const std::string& name) {
  for (const RobotCell& cell : task.more_robots)
    if (cell.gripper)
      for (const FingerSection& finger : cell.gripper->fingers)
        if (name == cell.name + "/" + finger.name) return true;
  return task.gripper && find_named(task.gripper->fingers, name);
}

bool holds(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

void need_object(const Section& root, const Task& task, const std::string& key, const std::string& name) {
  if (!find_named(task.objects, name)) root.fail(key, "names the object `" + name + "`, which `objects` does not hold");
}

void check_cloths(const Section& root, const Task& task, const std::vector<std::string>& bodies) {
  for (const ClothSection& section : task.cloths) {
    const std::string& name = section.cloth.name;
    const auto is_same = [&](const ClothSection& other) { return other.cloth.name == name; };
    if (std::count_if(task.cloths.begin(), task.cloths.end(), is_same) > 1 || find_named(task.objects, name) ||
        holds(bodies, name))
      root.fail("cloths", "holds the name `" + name + "`, which another body has, too");
    if (!section.look.empty() && !find_named(task.materials, section.look))
      root.fail("cloths", "holds `" + name + "` with the look `" + section.look + "`, which `materials` does not hold");
  }
}

void check_looks(const Section& root, const Task& task) {
  for (const ObjectSection& object : task.objects)
    for (const VisualSection& visual : object.visuals)
      if (!visual.material.empty() && !find_named(task.materials, visual.material))
        root.fail("objects", "holds `" + object.name + "` with the material `" + visual.material +
                                 "`, which `materials` does not hold");
}

// A pose may be in the frame of an object that stands above it in the file.
void check_frames(const Section& root, const Task& task) {
  for (std::size_t i = 0; i < task.objects.size(); ++i) {
    const std::string& frame = task.objects[i].pose.object;
    const auto end = task.objects.begin() + std::ptrdiff_t(i);
    if (!frame.empty() && std::none_of(task.objects.begin(), end, [&](const auto& o) { return o.name == frame; }))
      root.fail("objects", "holds `" + task.objects[i].name + "`, whose pose is in the frame of `" + frame +
                               "`, which does not stand above it");
  }
}

// Which of two entries of one pair would hold?
template <class Pair>
void check_each_pair_once(const Section& root, const std::string& key, const std::vector<Pair>& pairs) {
  std::set<std::pair<std::string, std::string>> seen;
  for (const Pair& pair : pairs)
    if (!seen.insert(std::minmax(pair.first, pair.second)).second)
      root.fail(key,
                "holds the pair of `" + pair.first + "` and `" + pair.second + "` twice; leave one of the two out");
}

void check_pairs(const Section& root, const Task& task, const std::vector<std::string>& bodies) {
  for (const PairFriction& pair : task.pair_friction)
    for (const std::string& name : {pair.first, pair.second})
      if (!holds(bodies, name) && !is_finger(task, name) && !is_cloth(task, name))
        need_object(root, task, "pair_friction", name);
  for (const PairRestitution& pair : task.pair_restitution)
    for (const std::string& name : {pair.first, pair.second})
      if (!holds(bodies, name)) need_object(root, task, "pair_restitution", name);
  check_each_pair_once(root, "pair_friction", task.pair_friction);
  check_each_pair_once(root, "pair_restitution", task.pair_restitution);
}

void check_mounts(const Section& root, const Task& task) {
  std::vector<std::string> mounts = {"world"};
  for (const RobotCell& robot : robots_of(task))
    if (robot.gripper) mounts.push_back((robot.name.empty() ? "" : robot.name + "/") + "gripper_base");
  for (const CameraSection& camera : task.cameras) {
    if (holds(mounts, camera.mount)) continue;
    std::string allowed;
    for (const std::string& mount : mounts) allowed += (allowed.empty() ? "" : ", ") + mount;
    root.fail("cameras",
              "mounts `" + camera.name + "` on `" + camera.mount + "`, but must mount it on one of: " + allowed);
  }
}

}  // namespace

void check_names(const Section& root, const Task& task, const std::vector<std::string>& bodies) {
  check_distinct(root, "objects", task.objects);
  check_cloths(root, task, bodies);
  check_distinct(root, "cameras", task.cameras);
  check_distinct(root, "lights", task.lights);
  check_distinct(root, "lights", task.sphere_lights);
  check_looks(root, task);
  for (const JointSection& joint : task.joints)
    for (const std::string& name : {joint.parent, joint.child}) need_object(root, task, "joints", name);
  check_frames(root, task);
  for (const MotionElement& element : task.motion)
    if (!element.object.empty() && !is_cloth(task, element.object)) need_object(root, task, "motion", element.object);
  check_pairs(root, task, bodies);
  check_mounts(root, task);
  for (const RobotCell& robot : robots_of(task))
    if (robot.gripper && !find_named(task.materials, robot.gripper->finger_material))
      root.fail("gripper",
                "wants the material `" + robot.gripper->finger_material + "`, which neither it nor `materials` holds");
}

void add_gripper_materials(const GripperSection& gripper, Task& task) {
  for (const VisualMaterial& material : gripper.materials)
    if (!find_named(task.materials, material.name)) task.materials.push_back(material);
}

Fields<Task> root_fields(double largest_time_step) {
  return Fields<Task>()
      .name(&Task::name, "of the scene or task")
      .number(
          "time_step", [](auto& task) -> auto& { return task.solver.time_step; }, Unit::time, 1e-6, largest_time_step,
          "of the simulation")
      .required();
}

const Fields<Task>& environment_fields() {
  static const Fields<Task> MAP =
      Fields<Task>()
          .file("file", &Task::environment_map,
                ".hdr, .exr, or 8 bits (sRGB); equirectangular, z up, +x in the middle, "
                "+y to the left")
          .required()
          .number("turn", &Task::environment_turn, Unit::angle, -2 * std::numbers::pi, 2 * std::numbers::pi, "about z");
  static const Fields<Task> FIELDS =
      Fields<Task>()
          .section("environment_map", std::identity{}, MAP, "picture of the surroundings")
          .only_file()
          .then([](Task& task) { task.environment = task.environment_map.empty() ? Vec3f::Zero() : Vec3f::Ones(); })
          .number("environment", &Task::environment, Unit::radiance, 0, 1e6,
                  "radiance where nothing is; with a map the scale of its picture")
          .otherwise("0, with a map 1")
          .file("environment_map", &Task::environment_map, "picture of the surroundings")
          .only_resolved()
          .number("environment_turn", &Task::environment_turn, Unit::angle, -2 * std::numbers::pi, 2 * std::numbers::pi,
                  "about z")
          .only_resolved();
  return FIELDS;
}

Task read_scene_sections(Section& root, double largest_time_step) {
  Task task;
  task.file = root.path();
  check_schema(root);
  read_if_there(root, "solver", solver_fields(), task.solver);
  root_fields(largest_time_step).read(root, task);
  environment_fields().read(root, task);
  read_if_there(root, "contact", contact_fields(), task.contact);
  carried_gripper_fields<Task>().read(root, task);
  add_materials(root, task.materials, &task.textures);
  if (task.gripper) add_gripper_materials(*task.gripper, task);
  read_list(root, "objects", object_fields(), task.objects);
  read_list(root, "cloths", cloth_fields(), task.cloths);
  read_list(root, "pair_friction", pair_friction_fields(), task.pair_friction);
  read_list(root, "pair_restitution", pair_restitution_fields(), task.pair_restitution);
  read_list(root, "effects", effect_fields(), task.effects);
  if (root.has("background") && root.section("background").has("capture"))
    task.background =
        add_captured_room(read_all(captured_background_fields(), root.section("background")), task.objects);
  else
    read_if_there(root, "background", background_fields(), task.background);
  for (Section& section : root.sections("lights")) read_light(section, task);
  read_list(root, "cameras", camera_fields(), task.cameras);
  read_if_there(root, "render", render_fields(), task.render);
  return task;
}

bool is_task_file(const std::filesystem::path& file) { return Section::load(file, "scene file").has("motion"); }

namespace {

void check_condition_names(const Section& root, const Task& task) {
  const auto check = [&](const char* key, const Condition& condition) {
    const auto demand = [&](bool is_there, const std::string& name, const char* list) {
      if (!is_there) root.fail(key, "names `" + name + "`, which `" + list + "` does not hold");
    };
    const bool is_cloth = std::any_of(task.cloths.begin(), task.cloths.end(),
                                      [&](const ClothSection& c) { return c.cloth.name == condition.of; });
    const bool is_object =
        find_named(task.objects, condition.of) && !find_named(task.objects, condition.of)->mesh.empty();
    switch (kind_of(condition).of) {
      case QuantityKind::Of::joint:
        demand(std::any_of(task.joints.begin(), task.joints.end(),
                           [&](const JointSection& j) { return j.joint.name == condition.of; }),
               condition.of, "joints");
        break;
      case QuantityKind::Of::cloth:
        demand(is_cloth, condition.of, "cloths");
        break;
      case QuantityKind::Of::object_or_cloth:
        demand(is_cloth || is_object, condition.of, "objects");
        break;
      case QuantityKind::Of::object:
        demand(is_object, condition.of, "objects");
    }
    if (!condition.target.empty()) demand(find_named(task.objects, condition.target), condition.target, "objects");
  };
  for (const Condition& condition : task.success) check("success", condition);
  for (const Condition& condition : task.failure) check("failure", condition);
}

}  // namespace

void add_robot_cell(const Section& section, RobotCell cell, Task& task) {
  if (find_named(task.more_robots, cell.name)) section.fail("name", "`" + cell.name + "` is taken by a robot above");
  if (cell.gripper) add_gripper_materials(*cell.gripper, task);
  task.more_robots.push_back(std::move(cell));
}

void refuse_scene(const Section& root) {
  for (const char* key : {"bodies", "stitches", "noncolliding", "gravity", "separate", "duration"})
    if (root.holds(key))
      root.fail(key,
                "is a key of scenes, but a task is needed here; give this file to `phyvisgen simulate`, or leave the "
                "key out");
}

Task load_task(const std::filesystem::path& file) {
  Section root = Section::load(file, "task file");
  refuse_scene(root);
  Task task = read_scene_sections(root, LARGEST_TASK_TIME_STEP);
  if (root.has("robots")) {
    if (root.has("robot")) root.fail("robots", "and `robot` exclude each other");
    for (const Section& section : root.sections("robots"))
      add_robot_cell(section, read_all(robot_cell_fields(), section), task);
  }
  std::vector<std::string> robots;
  for (const RobotCell& robot : robots_of(task)) {
    robots.push_back(robot.name);
    if (!robot.gripper) root.fail("", "lacks the key `gripper`: each robot of a task needs one");
  }
  if (robots.empty() && !root.holds("motion") && !root.holds("success"))
    root.fail("",
              "has neither `robot` nor `motion` nor `success`, which a task needs; give it to `phyvisgen simulate` if "
              "it is a scene");
  if (robots.empty()) root.fail("", "lacks the key `robot`: a task needs one, or several in `robots`");
  if (task.cameras.empty()) root.fail("", "lacks `cameras`: a task is filmed by at least one");
  read_list(root, "joints", task_joint_fields(), task.joints);
  task.motion = read_motion(root, robots_of(task));
  read_list(root, "success", condition_fields(robots, Condition::When::end), task.success);
  if (task.success.empty()) root.fail("", "lacks `success`: a task has at least one condition");
  read_list(root, "failure", condition_fields(robots, Condition::When::some_time), task.failure);
  read_list(root, "vary", variation_fields(), task.variations);
  read_if_there(root, "record", record_fields(), task.record);
  root.done();
  check_names(root, task, {});
  check_condition_names(root, task);
  return task;
}

}  // namespace pvg
