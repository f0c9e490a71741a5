#include "host/load/build_scene.hpp"

#include <cmath>

#include "host/base/error.hpp"
#include "host/base/hash.hpp"
#include "host/formats/mesh_files.hpp"
#include "host/formats/textures.hpp"
#include "host/geometry/mass_properties.hpp"
#include "host/geometry/mesh_parts.hpp"
#include "host/load/build_parts.hpp"
#include "host/load/read_sections.hpp"
#include "host/load/variation.hpp"

namespace pvg {
namespace {

// What the draw of numbers needs: a value in [0, 1) for each name.
struct Draw {
  std::uint64_t seed = 0, episode = 0;
  bool takes_middle = false;  // 1/2 for all
  std::vector<SampledValue>* record = nullptr;

  double operator()(const std::string& name, const Range& range) const {
    if (range.low == range.high) return range.low;
    const double share = takes_middle ? 0.5 : uniform_number(seed, episode, name);
    const double value = range.low + (range.high - range.low) * share;
    record->push_back({name, value});
    return value;
  }
};

Pose draw_pose(const Draw& draw, const std::string& name, const SampledPose& sampled) {
  using Eigen::AngleAxisd;
  Pose pose = Pose::Identity();
  const double x = draw(name + "/x", sampled.x), y = draw(name + "/y", sampled.y), z = draw(name + "/z", sampled.z);
  pose.translation() = Vec3(x, y, z);
  const double roll = draw(name + "/roll", sampled.roll), pitch = draw(name + "/pitch", sampled.pitch),
               yaw = draw(name + "/yaw", sampled.yaw);
  pose.linear() = (AngleAxisd(yaw, Vec3::UnitZ()) * AngleAxisd(pitch, Vec3::UnitY()) * AngleAxisd(roll, Vec3::UnitX()))
                      .toRotationMatrix();
  return pose;
}

}  // namespace

RigidBody rigid_body(const ObjectSection& object, const Pose& pose) {
  RigidBody body;
  body.name = object.name;
  body.collision = read_closed_surface(object.mesh);
  if (!object.is_fixed && has_overlapping_parts(body.collision))
    throw UsageError(object.mesh.string() +
                     " consists of closed parts that overlap, whose common space would count "
                     "twice in the mass; unite them into one surface, as `phyvisgen capture object` does");
  tell_of_size(body.collision, object.mesh.string());
  for (Vec3& point : body.collision.points) point *= object.size;
  body.is_fixed = object.is_fixed;
  body.friction = object.friction;
  body.affine_modulus = object.affine_modulus;
  body.pose = pose;
  // a fixed body's mass moves nothing: that of water stands in for it
  const double density = object.density > 0 ? object.density : 1000;
  MassProperties properties = mass_properties(body.collision, density);
  if (object.mass > 0) properties = mass_properties(body.collision, object.mass / properties.volume);
  body.mass = properties.mass;
  body.volume = properties.volume;
  body.center_of_mass = properties.center;
  body.inertia = properties.inertia;
  return body;
}

namespace {

// is_filmed: there are cameras; a scene without any is shown whole by who looks at it
void add_object(Scene& scene, const ObjectSection& object, const Draw& draw, bool is_filmed) {
  Pose pose = draw_pose(draw, object.name, object.pose);
  if (!object.pose.object.empty()) {
    const RigidBody* frame = find_named(scene.rigid_bodies, object.pose.object);
    if (!frame)
      throw UsageError("object `" + object.name + "`: its pose is in the frame of `" + object.pose.object +
                       "`, which has no `mesh`; give that one a mesh, or the pose in the world");
    pose = frame->pose * pose;
  }
  Visual visual;
  if (object.mesh.empty()) {
    visual.pose = pose;
  } else {
    visual.rigid = int(scene.rigid_bodies.size());
    scene.rigid_bodies.push_back(rigid_body(object, pose));
  }
  visual.name = visual.part = object.name;
  if (object.visuals.empty() && object.is_visible && is_filmed)
    add_plain_visual(scene, object.mesh, visual, object.size);
  else
    add_visuals(scene, object.visuals, visual, object.size);
  if (object.display.width > 0) add_display(scene, object.display, visual.rigid, object.size);
}

int rigid_index(const Scene& scene, const std::string& name) {
  const RigidBody* body = find_named(scene.rigid_bodies, name);
  if (!body) throw UsageError("`joints` names the object `" + name + "`, which has no `mesh`; only bodies have joints");
  return int(body - scene.rigid_bodies.data());
}

void add_joint(Scene& scene, const JointSection& section) {
  Joint joint = section.joint;
  joint.parent = rigid_index(scene, section.parent);
  joint.child = rigid_index(scene, section.child);
  joint.child_frame = scene.rigid_bodies[std::size_t(joint.child)].pose.inverse() *
                      scene.rigid_bodies[std::size_t(joint.parent)].pose * joint.parent_frame;
  scene.joints.push_back(joint);
}

void add_cloth(Scene& scene, const ClothSection& section, const Draw& draw) {
  scene.cloths.push_back(section.cloth);
  scene.cloths.back().pose = draw_pose(draw, section.cloth.name, section.pose);
  if (section.look.empty()) return;
  Visual visual;
  visual.name = visual.part = section.cloth.name;
  visual.material = material_index(scene, section.look);
  visual.cloth = int(scene.cloths.size()) - 1;
  visual.subdivision_levels = section.subdivision_levels;
  scene.visuals.push_back(visual);
}

void add_cameras(TaskScene& built, const Task& task) {
  for (const CameraSection& section : task.cameras) {
    Camera camera = section.optics;
    camera.name = section.name;
    camera.width = section.width;
    camera.height = section.height;
    camera.fx = camera.fy = section.height / 2.0 / std::tan(section.vertical_field_of_view / 2);
    camera.cx = (section.width - 1) / 2.0;  // pixel (0, 0) is a pixel's centre
    camera.cy = (section.height - 1) / 2.0;
    if (!section.intrinsics.empty()) {
      camera.fx = section.intrinsics[0] * section.height;
      camera.fy = section.intrinsics[1] * section.height;
      camera.cx = section.intrinsics[2] * section.width - 0.5;
      camera.cy = section.intrinsics[3] * section.height - 0.5;
    }
    for (const BuiltRobot& robot : built.robots)
      if (section.mount == (robot.name.empty() ? "" : robot.name + "/") + "gripper_base")
        camera.rigid = robot.gripper_base;
    camera.pose = section.pose;
    camera.exposure = section.exposure;
    built.scene.cameras.push_back(camera);
  }
}

TaskScene build(const Task& nominal, Draw draw) {
  TaskScene built;
  draw.record = &built.sampled;
  const Task task = varied(nominal, draw);
  built.disturbances = task.disturbances;
  Scene& scene = built.scene;
  scene.name = task.name;
  scene.contact = task.contact;
  scene.solver = task.solver;
  scene.pair_friction = task.pair_friction;
  scene.pair_restitution = task.pair_restitution;
  scene.effects = task.effects;
  scene.lights = task.lights;
  scene.sphere_lights = task.sphere_lights;
  scene.environment = task.environment;
  if (!task.environment_map.empty()) scene.environment_map = read_environment(task.environment_map);
  scene.environment_map.turn = task.environment_turn;
  scene.materials = task.materials;
  for (const auto& file : task.textures) scene.textures.push_back(read_texture(file));
  for (const RobotCell& robot : robots_of(task)) add_arm(built, robot);
  for (const ObjectSection& object : task.objects) add_object(scene, object, draw, !task.cameras.empty());
  for (const JointSection& joint : task.joints) add_joint(scene, joint);
  for (const ClothSection& section : task.cloths) add_cloth(scene, section, draw);
  add_background(scene, task.background);
  add_cameras(built, task);
  return built;
}

}  // namespace

double uniform_number(std::uint64_t seed, std::uint64_t episode, const std::string& name) {
  return double(mixed_bits(mixed_bits(mixed_bits(seed) ^ episode) ^ fnv1a(name)) >> 11) * 0x1p-53;
}

namespace {

// What is wrong is named with the file that says so: the task's, where the sentence begins with no other.
TaskScene build_or_name_file(const Task& task, const Draw& draw) {
  try {
    return build(task, draw);
  } catch (const UsageError& error) {
    const std::string said = error.what();
    if (task.file.empty() || said.starts_with('/')) throw;
    throw UsageError(task.file.string() + ": " + said);
  }
}

}  // namespace

TaskScene build_scene(const Task& task, std::uint64_t seed, std::uint64_t episode) {
  return build_or_name_file(task, {seed, episode, false, nullptr});
}

TaskScene build_scene_at_middle(const Task& task) { return build_or_name_file(task, {0, 0, true, nullptr}); }

}  // namespace pvg
