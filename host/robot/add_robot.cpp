#include "host/robot/add_robot.hpp"

#include <algorithm>
#include <set>

#include "host/base/error.hpp"

namespace pvg {
namespace {

constexpr double MATERIAL_DENSITY = 1000;  // turns a link's mass into the volume that its stiffness acts in [kg/m^3]

// Adds to a body the mass of a link whose frame in the body is `frame`.
void add_mass(RigidBody& body, const RobotLink& link, const Pose& frame) {
  if (link.mass == 0) return;
  const Vec3 center = frame * link.center_of_mass;
  const double total = body.mass + link.mass;
  const Vec3 common = (body.mass * body.center_of_mass + link.mass * center) / total;
  // parallel axes: a mass m at distance d from the common centre adds m (|d|^2 I - d d^T)
  const auto shifted = [&](double mass, const Vec3& at) {
    const Vec3 d = at - common;
    return Mat3(mass * (d.squaredNorm() * Mat3::Identity() - d * d.transpose()));
  };
  body.inertia += shifted(body.mass, body.center_of_mass) + shifted(link.mass, center) +
                  Mat3(frame.linear() * link.inertia * frame.linear().transpose());
  body.mass = total;
  body.center_of_mass = common;
  body.volume = total / MATERIAL_DENSITY;
}

void add_collision(RigidBody& body, const RobotLink& link, const Pose& frame) {
  const auto start = std::uint32_t(body.collision.points.size());
  for (const Vec3& p : link.collision.points) body.collision.points.push_back(frame * p);
  for (const Triangle& t : link.collision.triangles)
    body.collision.triangles.push_back({t[0] + start, t[1] + start, t[2] + start});
}

int find_material(Scene& scene, const LinkVisual& visual, const RobotOptions& options) {
  if (options.material >= 0) return options.material;
  if (const auto named = options.materials.find(visual.material); named != options.materials.end())
    return named->second;
  const std::string name = options.prefix + (visual.material.empty() ? "robot" : visual.material);
  for (std::size_t i = 0; i < scene.materials.size(); ++i)
    if (scene.materials[i].name == name && scene.materials[i].color == visual.color) return int(i);
  VisualMaterial material;
  material.name = name;
  material.color = visual.color;
  scene.materials.push_back(material);
  return int(scene.materials.size()) - 1;
}

void add_visuals(Scene& scene, const RobotLink& link, int body, const Pose& frame, const RobotOptions& options) {
  for (const LinkVisual& visual : link.visuals) {
    Visual seen;
    seen.name = options.prefix + link.name + "/" + visual.name;
    seen.mesh = int(scene.visual_meshes.size());
    seen.material = find_material(scene, visual, options);
    seen.rigid = body;
    seen.pose = frame;
    seen.part = options.part;
    scene.visual_meshes.push_back(visual.mesh);
    scene.visuals.push_back(seen);
  }
}

Drive drive_of(const RobotJoint& joint, const RobotOptions& options) {
  if (const auto own = options.drives.find(joint.name); own != options.drives.end()) return own->second;
  const bool slides = joint.type == Joint::Type::prismatic;
  Drive drive;
  drive.stiffness = slides ? options.prismatic_stiffness : options.stiffness;
  drive.damping = slides ? options.prismatic_damping : options.damping;
  drive.effort_limit = options.limits_effort ? joint.effort : 0;
  drive.compensates_gravity = options.compensates_gravity;
  return drive;
}

void check_names(const RobotModel& model, const RobotOptions& options) {
  for (const auto& [driven, drive] : options.drives) {
    const std::string& name = driven;
    if (std::none_of(model.joints.begin(), model.joints.end(), [&](auto& j) { return j.name == name; }))
      throw UsageError("robot '" + model.name + "' has no joint '" + name + "' to drive; correct the name");
  }
  if (options.collision_links)
    for (const std::string& name : *options.collision_links)
      if (model.links[model.link(name)].collision.triangles.empty())
        throw UsageError("robot '" + model.name + "': link '" + name +
                         "' shall collide but has no collision shape; add <collision> or leave the link out");
}

// Which body each link is part of: a link behind a fixed joint joins its parent's, unless fixed joints are kept.
void add_bodies(Scene& scene, const RobotModel& model, const std::vector<Pose>& poses, const RobotOptions& options,
                AddedRobot& added) {
  for (std::size_t i = 0; i < model.links.size(); ++i) {
    const RobotLink& link = model.links[i];
    const RobotJoint* joint = i == 0 ? nullptr : &model.joints[i - 1];
    const bool joins_parent =
        joint && joint->type == Joint::Type::fixed && (link.mass == 0 || !options.keeps_fixed_joints);
    if (joins_parent) {
      added.body.push_back(added.body[joint->parent]);
      added.link_in_body.push_back(added.link_in_body[joint->parent] * joint->origin);
    } else {
      added.body.push_back(int(scene.rigid_bodies.size()));
      added.link_in_body.push_back(Pose::Identity());
      RigidBody body;
      body.name = options.prefix + link.name;
      body.affine_modulus = options.affine_modulus;
      body.friction = options.friction;
      body.pose = poses[i];
      scene.rigid_bodies.push_back(body);
    }
    RigidBody& body = scene.rigid_bodies[added.body[i]];
    const auto& wanted = options.collision_links;
    add_mass(body, link, added.link_in_body[i]);
    if (!wanted || std::find(wanted->begin(), wanted->end(), link.name) != wanted->end())
      add_collision(body, link, added.link_in_body[i]);
    add_visuals(scene, link, added.body[i], added.link_in_body[i], options);
  }
}

void add_joints(Scene& scene, const RobotModel& model, const VectorXd& q, const RobotOptions& options,
                AddedRobot& added) {
  int next = 0;
  for (const RobotJoint& joint : model.joints) {
    if (added.body[joint.parent] == added.body[joint.child]) continue;
    Joint result;
    result.name = options.prefix + joint.name;
    result.type = joint.type;
    result.parent = added.body[joint.parent];
    result.child = added.body[joint.child];
    result.parent_frame = added.link_in_body[joint.parent] * joint.origin;  // a child's frame is its body's
    if (joint.type != Joint::Type::fixed) {
      result.axis = joint.axis;
      result.lower = joint.lower;
      result.upper = joint.upper;
      result.velocity_limit = joint.velocity;
      result.drive = drive_of(joint, options);
      result.initial = q[next++];
      if ((joint.lower != 0 || joint.upper != 0) && (result.initial < joint.lower || result.initial > joint.upper))
        throw UsageError("joint '" + joint.name + "' would start at " + std::to_string(result.initial) +
                         ", outside its limits " + std::to_string(joint.lower) + " to " + std::to_string(joint.upper) +
                         "; correct the start configuration");
      added.joints.push_back(int(scene.joints.size()));
    }
    scene.joints.push_back(result);
  }
}

void add_noncolliding(Scene& scene, const RobotModel& model, const AddedRobot& added) {
  std::set<std::array<int, 2>> pairs;
  for (const auto& [a, b] : model.noncolliding) {
    const int first = added.body[a], second = added.body[b];
    if (first != second) pairs.insert({std::min(first, second), std::max(first, second)});
  }
  scene.noncolliding_rigid_bodies.insert(scene.noncolliding_rigid_bodies.end(), pairs.begin(), pairs.end());
}

AddedRobot add_at(Scene& scene, const RobotModel& model, const Pose& base, const VectorXd& q,
                  const RobotOptions& options) {
  check_names(model, options);
  AddedRobot added;
  add_bodies(scene, model, link_poses(model, q, base), options, added);
  add_joints(scene, model, q, options, added);
  add_noncolliding(scene, model, added);
  return added;
}

}  // namespace

AddedRobot add_robot(Scene& scene, const RobotModel& model, const Pose& base, const VectorXd& q,
                     const RobotOptions& options) {
  const AddedRobot added = add_at(scene, model, base, q, options);
  scene.rigid_bodies[added.body[0]].is_fixed = true;
  return added;
}

AddedRobot attach_robot(Scene& scene, int parent_body, const Pose& base, const RobotModel& model, const VectorXd& q,
                        const RobotOptions& options) {
  if (parent_body < 0 || parent_body >= int(scene.rigid_bodies.size()))
    throw UsageError("robot '" + model.name + "' cannot be attached to body number " + std::to_string(parent_body) +
                     ", which does not exist; give a rigid body of the scene");
  if (model.links[0].mass == 0)
    throw UsageError("robot '" + model.name + "': its base link '" + model.links[0].name +
                     "' is carried by another body but has no mass; add <inertial>");
  Joint mount;
  mount.name = options.prefix + model.links[0].name + "_mount";
  mount.parent = parent_body;
  mount.child = int(scene.rigid_bodies.size());
  mount.parent_frame = base;
  scene.joints.push_back(mount);
  return add_at(scene, model, scene.rigid_bodies[parent_body].pose * base, q, options);
}

}  // namespace pvg
