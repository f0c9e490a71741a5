// A robot of a task with its gripper and fingers.
#include <algorithm>

#include "host/base/counted.hpp"
#include "host/base/error.hpp"
#include "host/formats/mesh_files.hpp"
#include "host/formats/tetgen.hpp"
#include "host/load/build_parts.hpp"
#include "host/robot/add_robot.hpp"

namespace pvg {
namespace {

VectorXd home_configuration(const RobotModel& model, const RobotSection& robot) {
  if (robot.home.size() != model.actuated.size()) {
    throw UsageError("`robot.home` holds " + counted(robot.home.size(), "number") + ", but " + robot.urdf.string() +
                     " has " + counted(model.actuated.size(), "moving joint") + ".");
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
    throw UsageError("Finger `" + finger.name + "`: its stitch box holds " + counted(stitch.nodes.size(), "node") +
                     ", at least 3 are needed to hold it; move `stitch.low` and `stitch.high`.");
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

}  // namespace

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
  for (std::size_t k = 0; k < robot.armature.size(); ++k)
    built.scene.joints[std::size_t(arm.joints[k])].armature = robot.armature[k];
  BuiltRobot& added = built.robots.emplace_back();
  added.name = cell.name;
  added.arm = arm.joints;
  added.flange = arm.body[std::size_t(flange_link)];
  added.arm_bodies = distinct(arm.body);
  if (cell.gripper) add_gripper(built.scene, added, *cell.gripper, arm, flange_link, options.prefix);
}

}  // namespace pvg
