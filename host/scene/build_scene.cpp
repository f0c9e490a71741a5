#include "host/scene/build_scene.hpp"

#include <algorithm>
#include <cmath>

#include "host/base/error.hpp"
#include "host/geometry/mass_properties.hpp"
#include "host/io/gltf_scene.hpp"
#include "host/io/mesh_files.hpp"
#include "host/io/tetgen.hpp"
#include "host/io/textures.hpp"
#include "host/robot/add_robot.hpp"
#include "host/scene/read_sections.hpp"
#include "host/scene/task_file.hpp"
#include "host/scene/variation.hpp"

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

int material_index(const Scene& scene, const std::string& name) {
  for (std::size_t i = 0; i < scene.materials.size(); ++i) {
    if (scene.materials[i].name == name) return int(i);
  }
  throw UsageError("There is no material `" + name + "`; add it to `materials`.");
}

RigidBody rigid_body(const ObjectSection& object, const Pose& pose) {
  RigidBody body;
  body.name = object.name;
  body.collision = read_closed_surface(object.mesh);
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

// the parts of a glTF file, each with the file's own material
void add_parts(Scene& scene, GltfScene gltf, const std::filesystem::path& file, const Visual& visual) {
  const int first_texture = int(scene.textures.size()), first_material = int(scene.materials.size());
  for (Texture& texture : gltf.textures) scene.textures.push_back(std::move(texture));
  for (VisualMaterial& material : gltf.materials) {
    material.name = file.filename().string() + "/" + material.name;
    for (int* index : {&material.texture, &material.metallic_roughness_texture, &material.normal_texture,
                       &material.emission_texture})
      if (*index >= 0) *index += first_texture;
    scene.materials.push_back(std::move(material));
  }
  for (GltfPart& part : gltf.parts) {
    Visual added = visual;
    added.name += "/" + part.name;
    added.mesh = int(scene.visual_meshes.size());
    added.material = first_material + part.material;
    added.casts_shadow_on_receivers =
        scene.materials[std::size_t(added.material)].kind != VisualMaterial::Kind::shadow_receiver;
    scene.visual_meshes.push_back(std::move(part.mesh));
    scene.visuals.push_back(added);
  }
}

}  // namespace

Scene gltf_as_scene(const std::filesystem::path& file, std::vector<std::string>* left_out) {
  GltfScene gltf = read_gltf_scene(file);
  Scene scene;
  scene.name = file.stem().string();
  scene.cameras = std::move(gltf.cameras);
  scene.sphere_lights = std::move(gltf.lights);
  *left_out = std::move(gltf.left_out);
  Visual visual;
  visual.name = visual.part = scene.name;
  add_parts(scene, std::move(gltf), file, visual);
  return scene;
}

void add_visuals(Scene& scene, const std::vector<VisualSection>& sections, const Visual& body, double size) {
  for (const VisualSection& section : sections) {
    Visual visual = body;
    visual.name += "/" + section.mesh.stem().string();
    if (section.material.empty()) {
      add_parts(scene, read_gltf_scene(section.mesh), section.mesh, visual);
      continue;
    }
    visual.mesh = int(scene.visual_meshes.size());
    visual.material = material_index(scene, section.material);
    scene.visual_meshes.push_back(read_visual_mesh(section.mesh, section.crease_angle));
    for (Vec3f& point : scene.visual_meshes.back().points) point *= float(size);
    scene.visuals.push_back(visual);
  }
}

namespace {

void add_object(Scene& scene, const ObjectSection& object, const Draw& draw) {
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
  add_visuals(scene, object.visuals, visual, object.size);
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

VectorXd home_configuration(const RobotModel& model, const RobotSection& robot) {
  if (robot.home.size() != model.actuated.size()) {
    throw UsageError("`robot.home` holds " + std::to_string(robot.home.size()) + " numbers, but " +
                     robot.urdf.string() + " has " + std::to_string(model.actuated.size()) + " joints that move.");
  }
  return Eigen::Map<const VectorXd>(robot.home.data(), Eigen::Index(robot.home.size()));
}

// All links of the gripper against the body that carries it and the two before that: they cannot meet.
void spare_wrist(Scene& scene, int flange_body, const AddedRobot& gripper) {
  std::vector<int> wrist = {flange_body};
  for (int step = 0; step < 2; ++step) {
    for (const Joint& joint : scene.joints) {
      if (joint.child == wrist.back()) {
        wrist.push_back(joint.parent);
        break;
      }
    }
  }
  for (const int link : gripper.body) {
    for (const int body : wrist) scene.noncolliding_rigid_bodies.push_back({body, link});
  }
}

// A stitch spring at each node inside the box.
Stitch stitch_of(const SoftBody& soft, const FingerSection& finger, int soft_index, int rigid_index) {
  Stitch stitch{soft_index, rigid_index, {}, finger.stitch_stiffness};
  for (std::size_t i = 0; i < soft.mesh.points.size(); ++i) {
    const Vec3& p = soft.mesh.points[i];
    if ((p.array() >= finger.stitch_low.array()).all() && (p.array() <= finger.stitch_high.array()).all()) {
      stitch.nodes.push_back(std::uint32_t(i));
    }
  }
  if (stitch.nodes.size() < 3) {
    throw UsageError("Finger `" + finger.name + "`: its stitch box holds " + std::to_string(stitch.nodes.size()) +
                     " nodes, at least 3 are needed to hold it; move `stitch.low` and `stitch.high`.");
  }
  return stitch;
}

// The same shape and mass, fixed to its carriage, instead of a soft finger.
int add_rigid_finger(Scene& scene, const FingerSection& finger, const GripperSection& gripper, int carriage_body,
                     const Pose& carriage_in_body, const std::string& prefix) {
  ObjectSection section;
  section.name = prefix + finger.name;
  section.mesh = finger.mesh;
  section.density = finger.material.density;
  section.friction = finger.friction;
  const Pose in_carriage = carriage_in_body * finger.pose;
  const int index = int(scene.rigid_bodies.size());
  scene.rigid_bodies.push_back(rigid_body(section, scene.rigid_bodies[std::size_t(carriage_body)].pose * in_carriage));
  Joint mount;
  mount.name = section.name + "_mount";
  mount.parent = carriage_body;
  mount.child = index;
  mount.parent_frame = in_carriage;
  scene.joints.push_back(mount);
  Visual visual;
  visual.name = section.name;
  visual.rigid = index;
  visual.part = "gripper";
  if (finger.visuals.empty()) {
    visual.material = material_index(scene, gripper.finger_material);
    visual.mesh = int(scene.visual_meshes.size());
    scene.visual_meshes.push_back(read_visual_mesh(finger.mesh, 0.7));
    scene.visuals.push_back(visual);
  }
  add_visuals(scene, finger.visuals, visual);
  return index;
}

int add_finger(Scene& scene, const FingerSection& finger, const GripperSection& gripper, int carriage_body,
               const Pose& carriage_in_body, const std::string& prefix) {
  SoftBody soft;
  soft.name = prefix + finger.name;
  const TetgenOptions options{finger.max_tetrahedron_volume, finger.radius_edge_ratio, finger.keeps_surface,
                              finger.nodes_per_element};
  soft.mesh = tetrahedralize(read_closed_surface(finger.mesh), options, finger.mesh.string());
  soft.material = finger.material;
  soft.friction = finger.friction;
  soft.pose = scene.rigid_bodies[carriage_body].pose * carriage_in_body * finger.pose;
  const int index = int(scene.soft_bodies.size());
  scene.stitches.push_back(stitch_of(soft, finger, index, carriage_body));
  scene.soft_bodies.push_back(std::move(soft));
  Visual visual;
  visual.name = prefix + finger.name;
  visual.soft = index;
  visual.subdivision_levels = gripper.subdivision_levels;
  visual.part = "gripper";
  if (finger.visuals.empty()) {
    visual.material = material_index(scene, gripper.finger_material);
    scene.visuals.push_back(visual);
  }
  add_visuals(scene, finger.visuals, visual);
  return index;
}

RobotOptions options_for(const Scene& scene) {
  RobotOptions options;
  for (std::size_t i = 0; i < scene.materials.size(); ++i) options.materials[scene.materials[i].name] = int(i);
  return options;
}

std::vector<int> distinct(std::vector<int> list) {
  std::sort(list.begin(), list.end());
  list.erase(std::unique(list.begin(), list.end()), list.end());
  return list;
}

void add_gripper(Scene& scene, BuiltRobot& built, const GripperSection& gripper, const AddedRobot& arm, int flange_link,
                 const std::string& prefix) {
  const RobotModel model = load_urdf(gripper.urdf);
  RobotOptions options = options_for(scene);
  options.prefix = prefix;
  options.prismatic_stiffness = gripper.drive_stiffness;
  options.prismatic_damping = gripper.drive_damping;
  options.part = "gripper";
  const VectorXd open = VectorXd::Constant(Eigen::Index(model.actuated.size()), gripper.open);
  if (model.link(gripper.base_link) != 0) {
    throw UsageError(gripper.file.string() + ": `base_link` must be the root of the URDF, which is `" +
                     model.links[0].name + "`.");
  }
  for (const std::string& name : gripper.joints) {
    const bool is_known = std::any_of(model.actuated.begin(), model.actuated.end(),
                                      [&](int joint) { return model.joints[joint].name == name; });
    if (!is_known)
      throw UsageError(gripper.file.string() + ": `joints` names `" + name + "`, which the URDF does not move.");
  }
  if (gripper.joints.size() != model.actuated.size()) {
    throw UsageError(gripper.file.string() + ": `joints` must name all joints that move in " + gripper.urdf.string() +
                     ".");
  }
  const Pose flange_in_body = arm.link_in_body[flange_link];
  const AddedRobot added = attach_robot(scene, built.flange, flange_in_body * gripper.mount, model, open, options);
  spare_wrist(scene, built.flange, added);
  built.gripper = added.joints;
  built.gripper_base = added.body[0];
  built.gripper_bodies = distinct(added.body);
  built.flange_to_tool = gripper.mount * gripper.tool_center;
  for (const FingerSection& finger : gripper.fingers) {
    const int carriage = model.link(finger.carriage);
    const int body = added.body[carriage];
    const Pose& in_body = added.link_in_body[carriage];
    if (gripper.is_rigid)
      built.rigid_fingers.push_back(add_rigid_finger(scene, finger, gripper, body, in_body, prefix));
    else
      built.soft_fingers.push_back(add_finger(scene, finger, gripper, body, in_body, prefix));
  }
}

void add_arm(TaskScene& built, const RobotCell& cell) {
  const RobotSection& robot = cell.robot;
  const RobotModel model = load_urdf(robot.urdf);
  RobotOptions options = options_for(built.scene);
  options.prefix = cell.name.empty() ? "" : cell.name + "/";
  options.stiffness = robot.drive_stiffness;
  options.damping = robot.drive_damping;
  options.friction = robot.friction;
  options.collision_links = robot.collision_links;
  const AddedRobot arm = add_robot(built.scene, model, robot.base, home_configuration(model, robot), options);
  const int flange_link = model.link(robot.flange);
  BuiltRobot& added = built.robots.emplace_back();
  added.name = cell.name;
  added.arm = arm.joints;
  added.flange = arm.body[std::size_t(flange_link)];
  added.arm_bodies = distinct(arm.body);
  if (cell.gripper) add_gripper(built.scene, added, *cell.gripper, arm, flange_link, options.prefix);
}

void add_background(Scene& scene, const BackgroundSection& background) {
  if (background.mesh.empty()) return;
  VisualMaterial material;
  material.name = "background";
  material.kind = VisualMaterial::Kind::shadow_receiver;
  material.color = Vec3f::Ones();
  material.texture = int(scene.textures.size());
  material.shadow_strength = background.shadow_strength;
  scene.textures.push_back(read_texture(background.texture));
  Visual visual;
  visual.name = visual.part = "background";
  visual.mesh = int(scene.visual_meshes.size());
  visual.material = int(scene.materials.size());
  visual.pose = background.pose;
  visual.casts_shadow_on_receivers = false;
  scene.materials.push_back(material);
  scene.visual_meshes.push_back(read_visual_mesh(background.mesh, 0));
  if (scene.visual_meshes.back().uvs.empty()) {
    throw UsageError(background.mesh.string() + ": the background has no texture coordinates; export it with them.");
  }
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
  Scene& scene = built.scene;
  scene.name = task.name;
  scene.contact = task.contact;
  scene.solver = task.solver;
  scene.pair_friction = task.pair_friction;
  scene.effects = task.effects;
  scene.lights = task.lights;
  scene.sphere_lights = task.sphere_lights;
  scene.environment = task.environment;
  if (!task.environment_map.empty()) scene.environment_map = read_environment(task.environment_map);
  scene.environment_map.turn = task.environment_turn;
  scene.materials = task.materials;
  for (const auto& file : task.textures) scene.textures.push_back(read_texture(file));
  for (const RobotCell& robot : robots_of(task)) add_arm(built, robot);
  for (const ObjectSection& object : task.objects) add_object(scene, object, draw);
  for (const JointSection& joint : task.joints) add_joint(scene, joint);
  for (const ClothSection& section : task.cloths) add_cloth(scene, section, draw);
  add_background(scene, task.background);
  add_cameras(built, task);
  return built;
}

}  // namespace

double uniform_number(std::uint64_t seed, std::uint64_t episode, const std::string& name) {
  // FNV-1a of the name, then the finaliser of SplitMix64 (Steele, Lea & Flood 2014) over one word after the other
  std::uint64_t hash = 0xcbf29ce484222325;
  for (const unsigned char c : name) hash = (hash ^ c) * 0x100000001b3;
  const auto mixed = [](std::uint64_t z) {
    z += 0x9e3779b97f4a7c15;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9;
    z = (z ^ (z >> 27)) * 0x94d049bb133111eb;
    return z ^ (z >> 31);
  };
  return double(mixed(mixed(mixed(seed) ^ episode) ^ hash) >> 11) * 0x1p-53;
}

TaskScene build_scene(const Task& task, std::uint64_t seed, std::uint64_t episode) {
  return build(task, {seed, episode, false, nullptr});
}

TaskScene build_scene_at_middle(const Task& task) { return build(task, {0, 0, true, nullptr}); }

}  // namespace pvg
