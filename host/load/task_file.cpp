#include "host/load/task_file.hpp"

#include "host/load/read_cloth.hpp"
#include "host/load/read_sections.hpp"

namespace pvg {
namespace {

constexpr double PI = std::numbers::pi;
constexpr double LARGEST_TIME_STEP = 0.02;  // of an episode [s]

using Section = YamlSection;

RenderSection read_render(Section& root) {
  RenderSection render;
  if (!root.has("render")) return render;
  Section section = root.section("render");
  render.frames_per_second = section.number("frames_per_second", Unit::frequency, 0.1, 1000, render.frames_per_second);
  render.samples = section.integer("samples", 1, 65536, render.samples);
  render.max_depth = section.integer("max_depth", 1, 64, render.max_depth);
  if (section.has("lut")) render.lut = section.file("lut");
  section.done();
  return render;
}

}  // namespace

RobotSection read_robot(Section section) {
  RobotSection robot;
  robot.urdf = section.file("urdf");
  robot.base = read_pose(section, "base");
  robot.home = section.numbers("home", Unit::angle, -1e3, 1e3);
  robot.flange = section.text("flange");
  if (section.has("drive")) {
    Section drive = section.section("drive");
    robot.drive_stiffness = drive.number("stiffness", Unit::angular_stiffness, 1e-3, 1e9);
    robot.drive_damping = drive.number("damping", Unit::angular_damping, 0, 1e6, 0);
    drive.done();
  }
  robot.friction = section.number("friction", Unit::none, 0, 10, robot.friction);
  if (section.has("collision_links")) robot.collision_links = section.texts("collision_links");
  section.done();
  return robot;
}

void check_names(const Section& root, const Task& task, const std::vector<std::string>& bodies) {
  check_distinct(root, "objects", task.objects);
  for (const ClothSection& section : task.cloths) {
    const std::string& name = section.cloth.name;
    const auto is_same = [&](const ClothSection& other) { return other.cloth.name == name; };
    if (std::count_if(task.cloths.begin(), task.cloths.end(), is_same) > 1 || find_named(task.objects, name) ||
        std::find(bodies.begin(), bodies.end(), name) != bodies.end())
      root.fail("cloths", "holds the name `" + name + "`, which another body has, too");
    if (!section.look.empty() && !find_named(task.materials, section.look))
      root.fail("cloths", "holds `" + name + "` with the look `" + section.look + "`, which `materials` does not hold");
  }
  check_distinct(root, "cameras", task.cameras);
  check_distinct(root, "lights", task.lights);
  check_distinct(root, "lights", task.sphere_lights);
  const auto need_object = [&](const std::string& key, const std::string& name) {
    if (!find_named(task.objects, name))
      root.fail(key, "names the object `" + name + "`, which `objects` does not hold");
  };
  const auto is_finger = [&](const std::string& name) {
    for (const RobotCell& cell : task.more_robots)
      if (cell.gripper)
        for (const FingerSection& finger : cell.gripper->fingers)
          if (name == cell.name + "/" + finger.name) return true;
    return task.gripper && find_named(task.gripper->fingers, name);
  };
  const auto is_cloth = [&](const std::string& name) {
    return std::any_of(task.cloths.begin(), task.cloths.end(),
                       [&](const ClothSection& section) { return section.cloth.name == name; });
  };
  for (const ObjectSection& object : task.objects) {
    for (const VisualSection& visual : object.visuals) {
      if (!visual.material.empty() && !find_named(task.materials, visual.material)) {
        root.fail("objects", "holds `" + object.name + "` with the material `" + visual.material +
                                 "`, which `materials` does not hold");
      }
    }
  }
  for (const JointSection& joint : task.joints) {
    need_object("joints", joint.parent);
    need_object("joints", joint.child);
  }
  for (std::size_t i = 0; i < task.objects.size(); ++i) {
    const std::string& frame = task.objects[i].pose.object;
    const auto end = task.objects.begin() + std::ptrdiff_t(i);
    if (!frame.empty() && std::none_of(task.objects.begin(), end, [&](const auto& o) { return o.name == frame; }))
      root.fail("objects", "holds `" + task.objects[i].name + "`, whose pose is in the frame of `" + frame +
                               "`, which does not stand above it");
  }
  for (const MotionElement& element : task.motion) {
    if (!element.object.empty() && !is_cloth(element.object)) need_object("motion", element.object);
  }
  for (const PairFriction& pair : task.pair_friction) {
    for (const std::string& name : {pair.first, pair.second}) {
      const bool is_body = std::find(bodies.begin(), bodies.end(), name) != bodies.end();
      if (!is_body && !is_finger(name) && !is_cloth(name)) need_object("pair_friction", name);
    }
  }
  std::vector<std::string> mounts = {"world"};
  for (const RobotCell& robot : robots_of(task))
    if (robot.gripper) mounts.push_back((robot.name.empty() ? "" : robot.name + "/") + "gripper_base");
  for (const CameraSection& camera : task.cameras) {
    if (std::find(mounts.begin(), mounts.end(), camera.mount) != mounts.end()) continue;
    std::string allowed;
    for (const std::string& mount : mounts) allowed += (allowed.empty() ? "" : ", ") + mount;
    root.fail("cameras",
              "mounts `" + camera.name + "` on `" + camera.mount + "`, but must mount it on one of: " + allowed);
  }
  for (const RobotCell& robot : robots_of(task)) {
    if (robot.gripper && !find_named(task.materials, robot.gripper->finger_material))
      root.fail("gripper",
                "wants the material `" + robot.gripper->finger_material + "`, which neither it nor `materials` holds");
  }
}

GripperSection read_gripper(Section& section, Task& task) {
  GripperSection gripper = load_gripper(section.file("gripper"));
  for (const VisualMaterial& material : gripper.materials) {  // the task's own win
    if (!find_named(task.materials, material.name)) task.materials.push_back(material);
  }
  return gripper;
}

Task read_scene_sections(Section& root, double largest_time_step) {
  Task task;
  task.file = root.path();
  check_schema(root);
  task.name = root.text("name");
  task.solver = read_solver(root, largest_time_step);
  task.contact = read_contact(root);
  if (root.has("robot")) task.robot = read_robot(root.section("robot"));
  add_materials(root, task.materials, &task.textures);
  if (root.has("gripper")) {
    if (task.robot.urdf.empty()) root.fail("gripper", "needs a `robot` that carries it");
    task.gripper = read_gripper(root, task);
  }
  for (Section& section : root.sections("objects")) task.objects.push_back(read_object(section));
  for (Section& section : root.sections("cloths")) task.cloths.push_back(read_cloth(section));
  for (Section& section : root.sections("pair_friction")) {
    task.pair_friction.push_back(
        {section.text("first"), section.text("second"), section.number("coefficient", Unit::none, 0, 10)});
    section.done();
  }
  for (Section& section : root.sections("effects")) task.effects.push_back(read_effect(section));
  if (root.has("background")) task.background = read_background(root.section("background"));
  for (Section& section : root.sections("lights")) read_light(section, task);
  if (root.has("environment_map")) {
    Section section = root.section("environment_map");
    task.environment_map = section.file("file");
    task.environment_turn = section.number("turn", Unit::angle, -2 * PI, 2 * PI, 0);
    section.done();
  }
  const Vec3f sky = task.environment_map.empty() ? Vec3f::Zero() : Vec3f::Ones();
  task.environment = read_color(root, "environment", sky, 1e6, Unit::radiance);
  for (Section& section : root.sections("cameras")) task.cameras.push_back(read_camera(section));
  task.render = read_render(root);
  return task;
}

bool is_task_file(const std::filesystem::path& file) { return Section::load(file, "scene file").has("motion"); }

namespace {

void check_condition_names(const Section& root, const Task& task) {
  using Quantity = Condition::Quantity;
  const auto check = [&](const char* key, const Condition& condition) {
    const auto demand = [&](bool is_there, const std::string& name, const char* list) {
      if (!is_there) root.fail(key, "names `" + name + "`, which `" + list + "` does not hold");
    };
    const bool is_cloth = std::any_of(task.cloths.begin(), task.cloths.end(),
                                      [&](const ClothSection& c) { return c.cloth.name == condition.of; });
    const bool is_object =
        find_named(task.objects, condition.of) && !find_named(task.objects, condition.of)->mesh.empty();
    if (condition.quantity == Quantity::joint_angle)
      demand(std::any_of(task.joints.begin(), task.joints.end(),
                         [&](const JointSection& j) { return j.joint.name == condition.of; }),
             condition.of, "joints");
    else if (condition.quantity == Quantity::corner_distance || condition.quantity == Quantity::edge_distance)
      demand(is_cloth, condition.of, "cloths");
    else if (condition.quantity == Quantity::held || condition.quantity == Quantity::height)
      demand(is_cloth || is_object, condition.of, "objects");
    else
      demand(is_object, condition.of, "objects");
    if (!condition.target.empty()) demand(find_named(task.objects, condition.target), condition.target, "objects");
  };
  for (const Condition& condition : task.success) check("success", condition);
  for (const Condition& condition : task.failure) check("failure", condition);
}

}  // namespace

RobotCell read_robot_cell(Section& section, Task& task) {
  RobotCell cell;
  cell.name = section.text("name");
  if (find_named(task.more_robots, cell.name)) section.fail("name", "`" + cell.name + "` is taken by a robot above");
  cell.robot = read_robot(section.section("robot"));
  if (section.has("gripper")) cell.gripper = read_gripper(section, task);
  return cell;
}

Task load_task(const std::filesystem::path& file) {
  Section root = Section::load(file, "task file");
  Task task = read_scene_sections(root, LARGEST_TIME_STEP);
  if (root.has("robots")) {
    if (root.has("robot")) root.fail("robots", "and `robot` exclude each other");
    for (Section& section : root.sections("robots")) {
      task.more_robots.push_back(read_robot_cell(section, task));
      section.done();
    }
  }
  std::vector<std::string> robots;
  for (const RobotCell& robot : robots_of(task)) {
    robots.push_back(robot.name);
    if (!robot.gripper) root.fail("", "lacks the key `gripper`: each robot of a task needs one");
  }
  if (robots.empty()) root.fail("", "lacks the key `robot`: a task needs one, or several in `robots`");
  if (task.cameras.empty()) root.fail("", "lacks `cameras`: a task is filmed by at least one");
  for (Section& section : root.sections("joints")) task.joints.push_back(read_task_joint(section));
  task.motion = read_motion(root, robots_of(task));
  for (Section& section : root.sections("success"))
    task.success.push_back(read_condition(section, robots, Condition::When::end));
  if (task.success.empty()) root.fail("", "lacks `success`: a task has at least one condition");
  for (Section& section : root.sections("failure"))
    task.failure.push_back(read_condition(section, robots, Condition::When::some_time));
  for (Section& section : root.sections("vary")) task.variations.push_back(read_variation(section));
  root.done();
  check_names(root, task, {});
  check_condition_names(root, task);
  return task;
}

}  // namespace pvg
