#include "host/load/read_bodies.hpp"

#include <Eigen/Geometry>
#include <cmath>

#include "host/geometry/mass_properties.hpp"
#include "host/geometry/mesh_parts.hpp"
#include "host/load/read_sections.hpp"
#include "host/load/read_shapes.hpp"
#include "host/load/tables.hpp"

namespace pvg {
namespace {

using Section = YamlSection;
using BodyKind = BodySection::Kind;
constexpr double START_TOLERANCE = 1e-6;  // joint frames of parent and child agree at the start within this [m, rad]

template <class Body>
int index_of(Section& section, const std::string& key, const std::vector<Body>& bodies, const std::string& kind) {
  const std::string name = section.text(key);
  if (const int index = index_named(bodies, name); index >= 0) return index;
  section.fail(key, "names `" + name + "`, which is no " + kind + " of `bodies`");
}

int index_of_cloth(Section& section, const std::vector<ClothSection>& cloths) {
  const std::string name = section.text("cloth");
  for (std::size_t i = 0; i < cloths.size(); ++i)
    if (cloths[i].cloth.name == name) return int(i);
  section.fail("cloth", "names `" + name + "`, which `cloths` does not hold");
}

void set_mass(const Section& section, const BodySection& read, RigidBody& body) {
  if (read.kind != BodyKind::rigid) {  // nothing moves it
    body.mass = body.volume = 1;
    body.inertia = Mat3::Identity();
    return;
  }
  const bool is_given = read.mass && read.inertia && read.center_of_mass;  // nothing is taken from the shape
  if (!is_given && has_overlapping_parts(body.collision))
    section.fail("shape",
                 "consists of closed parts that overlap, whose common space would count twice in the mass; "
                 "unite them into one surface, or give `mass`, `center_of_mass` and `inertia`");
  MassProperties properties = mass_properties(body.collision, 1);
  properties = mass_properties(body.collision, read.density ? *read.density : *read.mass / properties.volume);
  body.mass = properties.mass;
  body.volume = properties.volume;
  body.center_of_mass = read.center_of_mass.value_or(properties.center);
  body.inertia = read.inertia.value_or(properties.inertia);
}

RigidBody rigid_of(const Section& section, const BodySection& read) {
  RigidBody body;
  body.name = read.name;
  body.collision = read.surface;
  body.is_fixed = read.kind == BodyKind::fixed || read.kind == BodyKind::half_space;
  body.is_half_space = read.kind == BodyKind::half_space;
  body.is_prescribed = read.kind == BodyKind::moving;
  set_mass(section, read, body);
  body.friction = read.friction;
  body.contact_offset = read.contact_offset;
  body.affine_modulus = read.affine_modulus;
  body.pose = read.pose;
  body.path = read.path;
  body.velocity = read.velocity;
  body.angular_velocity = read.angular_velocity;
  if (!read.collides) body.collision = {};  // PassingSurface keeps it
  if (!body.is_half_space) return body;
  body.pose.linear() = Eigen::Quaterniond::FromTwoVectors(Vec3::UnitZ(), read.normal).toRotationMatrix();
  body.pose.translation() = read.point;
  return body;
}

SoftBody soft_of(const BodySection& read) {
  SoftBody body;
  body.name = read.name;
  body.mesh = read.solid;
  body.material = read.material;
  body.friction = read.friction;
  body.contact_offset = read.contact_offset;
  body.pose = read.pose;
  body.velocity = read.velocity;
  return body;
}

// What the coordinate q does to the child's frame, in the joint's frame.
Pose motion_of(const Joint& joint, double q) {
  Pose motion = Pose::Identity();
  if (joint.type == Joint::Type::revolute) motion.linear() = Eigen::AngleAxisd(q, joint.axis).toRotationMatrix();
  if (joint.type == Joint::Type::prismatic) motion.translation() = q * joint.axis;
  return motion;
}

TargetTable targets_of(const DriveSection& drive, const Joint& joint) {
  if (!drive.target.time.empty()) return drive.target;
  return {{0}, {drive.drive.mode == Drive::Mode::position ? joint.initial : 0}};
}

}  // namespace

void read_body(Section& section, SceneFile& file) {
  PhysicalScene& scene = file.added;
  BodySection read = read_all(body_fields(), section);
  const bool is_taken = find_named(scene.rigid_bodies, read.name) || find_named(scene.soft_bodies, read.name) ||
                        find_named(file.task.objects, read.name);
  if (is_taken) section.fail("name", "`" + read.name + "` is taken by a body above");
  const bool is_soft = read.kind == BodyKind::soft;
  if (is_soft)
    scene.soft_bodies.push_back(soft_of(read));
  else
    scene.rigid_bodies.push_back(rigid_of(section, read));
  if (!is_soft && !read.collides) file.passing_surfaces.push_back({int(scene.rigid_bodies.size()) - 1, read.surface});
  if (read.visuals.empty() && read.display.width == 0) return;
  BodyVisuals visuals;
  (is_soft ? visuals.soft : visuals.rigid) = int(is_soft ? scene.soft_bodies.size() : scene.rigid_bodies.size()) - 1;
  visuals.visuals = std::move(read.visuals);
  visuals.display = read.display;
  file.visuals.push_back(std::move(visuals));
}

void read_joint(Section& section, SceneFile& file) {
  PhysicalScene& scene = file.added;
  const SceneJointSection read = read_all(scene_joint_fields(), section);
  Joint joint = read.joint;
  if (find_named(scene.joints, joint.name)) section.fail("name", "`" + joint.name + "` is taken by a joint above");
  joint.parent = index_of(section, "parent", scene.rigid_bodies, "rigid or static body");
  joint.child = index_of(section, "child", scene.rigid_bodies, "rigid or static body");
  if (joint.parent == joint.child) section.fail("child", "must not be the parent");
  const Pose in_world =
      scene.rigid_bodies[std::size_t(joint.parent)].pose * joint.parent_frame * motion_of(joint, joint.initial);
  const Pose as_started = scene.rigid_bodies[std::size_t(joint.child)].pose.inverse() * in_world;
  joint.child_frame = read.child_frame.value_or(as_started);
  const Pose apart = as_started.inverse() * joint.child_frame;
  const bool may_turn = joint.type == Joint::Type::spherical;
  if (apart.translation().norm() > START_TOLERANCE ||
      (!may_turn && Eigen::AngleAxisd(apart.linear()).angle() > START_TOLERANCE))
    section.fail("child_frame", "does not meet `parent_frame` at the start; move the bodies, or leave it out");
  if (read.drive.is_there) {
    joint.drive = read.drive.drive;
    file.targets.push_back(targets_of(read.drive, joint));
  }
  scene.joints.push_back(joint);
}

void read_stitch(Section& section, SceneFile& file) {
  PhysicalScene& scene = file.added;
  const StitchSection read = read_all(stitch_fields(), section);
  Stitch stitch = read.stitch;
  if (!read.soft.empty())
    stitch.soft = index_of(section, "soft", scene.soft_bodies, "soft body");
  else
    stitch.cloth = index_of_cloth(section, file.task.cloths);
  stitch.rigid = index_of(section, "rigid", scene.rigid_bodies, "rigid or static body");
  stitch.nodes = stitch.soft >= 0
                     ? points_within(section, read.low, read.high,
                                     scene.soft_bodies[std::size_t(stitch.soft)].mesh.points, "soft body")
                     : points_within(section, read.low, read.high,
                                     file.task.cloths[std::size_t(stitch.cloth)].cloth.mesh.points, "cloth");
  scene.stitches.push_back(stitch);
}

void read_noncolliding(Section& section, SceneFile& file) {
  const NoncollidingPair pair = read_all(noncolliding_fields(), section);
  std::vector<RigidBody>& bodies = file.added.rigid_bodies;
  file.added.noncolliding_rigid_bodies.push_back({index_named(bodies, pair.first), index_named(bodies, pair.second)});
  for (const int body : file.added.noncolliding_rigid_bodies.back())
    if (body < 0) section.fail("", "must name two rigid or static bodies of `bodies`");
}

}  // namespace pvg
