#include "host/load/read_bodies.hpp"

#include <Eigen/Geometry>
#include <cmath>

#include "host/geometry/mass_properties.hpp"
#include "host/geometry/mesh_parts.hpp"
#include "host/load/read_sections.hpp"
#include "host/load/read_shapes.hpp"

namespace pvg {
namespace {

using Section = YamlSection;
constexpr double FASTEST = 1e3;           // [m/s]
constexpr double MOST_TURNS = 1e4;        // [rad/s]
constexpr double LARGEST_ANGLE = 1e3;     // of a joint, counted in turns [rad]
constexpr double START_TOLERANCE = 1e-6;  // joint frames of parent and child agree at the start within this [m, rad]

enum Kind { RIGID, SOFT, STATIC, MOVING, HALF_SPACE };

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

// [kg m^2]; of a real body no moment exceeds the sum of the other two
Mat3 read_inertia(Section& section) {
  const Vec3 moments = section.vector("inertia", Unit::inertia, 1e-15, 1e9);
  if (2 * moments.maxCoeff() > moments.sum() * (1 + 1e-9))
    section.fail("inertia", "has a moment above the sum of the two others, which no body can have");
  return moments.asDiagonal();
}

void set_mass(Section& section, RigidBody& body) {
  if (body.is_fixed) {  // nothing moves it
    body.mass = body.volume = 1;
    body.inertia = Mat3::Identity();
    return;
  }
  if (section.has("density") == section.has("mass"))
    section.fail("", "must have either `density` or `mass`, because it can move");
  if (has_overlapping_parts(body.collision))
    section.fail("shape",
                 "consists of closed parts that overlap, whose common space would count twice in the mass; "
                 "unite them into one surface");
  MassProperties properties = mass_properties(body.collision, 1);
  const double density = section.has("density") ? section.number("density", Unit::density, 1e-3, 1e5)
                                                : section.number("mass", Unit::mass, 1e-9, 1e6) / properties.volume;
  properties = mass_properties(body.collision, density);
  body.mass = properties.mass;
  body.volume = properties.volume;
  body.center_of_mass = properties.center;
  body.inertia = properties.inertia;
  if (section.has("inertia")) body.inertia = read_inertia(section);
}

RigidBody read_rigid(Section& section, const std::string& name, bool is_fixed) {
  RigidBody body;
  body.name = name;
  body.is_fixed = is_fixed;
  body.collision = read_surface_shape(section.section("shape"), is_fixed);
  set_mass(section, body);
  body.friction = section.number("friction", Unit::none, 0, 10, body.friction);
  body.contact_offset = section.number("contact_offset", Unit::length, 0, 1, 0);
  body.pose = read_pose(section, "pose");
  if (!is_fixed) {
    body.affine_modulus = section.number("affine_modulus", Unit::pressure, 1e3, 1e13, body.affine_modulus);
    body.velocity = section.vector("velocity", Unit::speed, -FASTEST, FASTEST, Vec3::Zero());
    body.angular_velocity =
        section.vector("angular_velocity", Unit::angular_speed, -MOST_TURNS, MOST_TURNS, Vec3::Zero());
  }
  if (!section.boolean("collides", true)) body.collision = {};
  return body;
}

// A body that goes its way whatever it meets: along `path`, or at constant velocities.
RigidBody read_moving(Section& section, const std::string& name) {
  RigidBody body = read_rigid(section, name, true);
  body.is_fixed = false;
  body.is_prescribed = true;
  if (!section.has("path")) {
    body.velocity = section.vector("velocity", Unit::speed, -FASTEST, FASTEST, Vec3::Zero());
    body.angular_velocity =
        section.vector("angular_velocity", Unit::angular_speed, -MOST_TURNS, MOST_TURNS, Vec3::Zero());
    return body;
  }
  if (section.has("pose")) section.fail("pose", "must not stand beside `path`, which says where the body starts");
  for (Section& point : section.sections("path")) {
    body.path.push_back({point.number("time", Unit::time, 0, 1e6), read_pose(point)});
    if (body.path.size() == 1 ? body.path[0].time != 0 : !(body.path.back().time > body.path.end()[-2].time))
      point.fail("time", "must be 0 at the first point of a path and ascend from there");
    point.done();
  }
  if (body.path.empty()) section.fail("path", "must hold at least one point");
  body.pose = body.path[0].pose;
  return body;
}

RigidBody read_half_space(Section& section, const std::string& name) {
  RigidBody body;
  body.name = name;
  body.is_fixed = body.is_half_space = true;
  set_mass(section, body);
  const Vec3 normal = section.vector("normal", Unit::none, -1e6, 1e6, Vec3::UnitZ());
  if (!(normal.norm() > 1e-9)) section.fail("normal", "must not have the length zero");
  body.pose.linear() = Eigen::Quaterniond::FromTwoVectors(Vec3::UnitZ(), normal).toRotationMatrix();
  body.pose.translation() = section.vector("point", Unit::length, -REACH, REACH, Vec3::Zero());
  body.friction = section.number("friction", Unit::none, 0, 10, body.friction);
  body.contact_offset = section.number("contact_offset", Unit::length, 0, 1, 0);
  return body;
}

SoftBody read_soft(Section& section, const std::string& name) {
  SoftBody body;
  body.name = name;
  body.mesh = read_solid_shape(section.section("shape"));
  Section material = section.section("material");
  body.material.density = material.number("density", Unit::density, 1e-6, 1e5);
  body.material.youngs_modulus = material.number("youngs_modulus", Unit::pressure, 1, 1e12);
  body.material.poisson_ratio = material.number("poisson_ratio", Unit::none, 0, 0.4999);
  material.done();
  body.friction = section.number("friction", Unit::none, 0, 10, body.friction);
  body.contact_offset = section.number("contact_offset", Unit::length, 0, 1, 0);
  body.pose = read_pose(section, "pose");
  body.velocity = section.vector("velocity", Unit::speed, -FASTEST, FASTEST, Vec3::Zero());
  return body;
}

// What the coordinate q does to the child's frame, in the joint's frame.
Pose motion_of(const Joint& joint, double q) {
  Pose motion = Pose::Identity();
  if (joint.type == Joint::Type::revolute) motion.linear() = Eigen::AngleAxisd(q, joint.axis).toRotationMatrix();
  if (joint.type == Joint::Type::prismatic) motion.translation() = q * joint.axis;
  return motion;
}

TargetTable read_targets(Section& drive, Unit unit, double largest, double initial) {
  if (!drive.has("target")) return {{0}, {initial}};
  if (!drive.has("target_times")) return {{0}, {drive.number("target", unit, -largest, largest)}};
  TargetTable table{drive.numbers("target_times", Unit::time, 0, 1e6),
                    drive.numbers("target", unit, -largest, largest)};
  if (table.time.empty() || table.time.size() != table.value.size())
    drive.fail("target", "and `target_times` must be lists of equal length, at least one entry");
  for (std::size_t i = 1; i < table.time.size(); ++i)
    if (!(table.time[i] > table.time[i - 1])) drive.fail("target_times", "must ascend");
  return table;
}

TargetTable read_drive_targets(Section& drive, const Joint& joint) {
  const bool turns = joint.type == Joint::Type::revolute;
  switch (joint.drive.mode) {
    case Drive::Mode::velocity:
      return read_targets(drive, turns ? Unit::angular_speed : Unit::speed, turns ? MOST_TURNS : FASTEST, 0);
    case Drive::Mode::torque:
      return read_targets(drive, turns ? Unit::torque : Unit::force, 1e12, 0);
    default:
      return read_targets(drive, turns ? Unit::angle : Unit::length, turns ? LARGEST_ANGLE : REACH, joint.initial);
  }
}

void read_drive(Section drive, Joint& joint, SceneFile& file) {
  const bool turns = joint.type == Joint::Type::revolute;
  if (!turns && joint.type != Joint::Type::prismatic)
    drive.fail("", "is of no use: only revolute and prismatic joints have a coordinate to drive");
  Drive& d = joint.drive;
  d.mode = Drive::Mode(drive.choice("mode", {"position", "velocity", "torque"}, 0));
  if (d.mode == Drive::Mode::position)
    d.stiffness = drive.number("stiffness", turns ? Unit::angular_stiffness : Unit::stiffness, 0, 1e12, 0);
  if (d.mode != Drive::Mode::torque)
    d.damping = drive.number("damping", turns ? Unit::angular_damping : Unit::damping, 0, 1e12, 0);
  d.effort_limit = drive.number("effort_limit", turns ? Unit::torque : Unit::force, 0, 1e12, 0);
  d.compensates_gravity = drive.boolean("compensates_gravity", false);
  if (!is_driven(joint)) drive.fail("", "needs a `damping` above 0, or in the mode `position` a `stiffness`");
  file.targets.push_back(read_drive_targets(drive, joint));
  drive.done();
}

void read_limits(Section& section, Unit unit, double largest, Joint& joint) {
  const std::vector<double> limits = section.numbers("limits", unit, -largest, largest);
  if (limits.size() != 2 || !(limits[0] < limits[1])) section.fail("limits", "must be [lowest, highest]");
  joint.lower = limits[0];
  joint.upper = limits[1];
  if (joint.initial < joint.lower || joint.initial > joint.upper)
    section.fail("limits", "do not hold the joint's `initial` position");
  const Unit stiffness = joint.type == Joint::Type::revolute ? Unit::angular_stiffness : Unit::stiffness;
  joint.limit_stiffness = section.number("limit_stiffness", stiffness, 1e-3, 1e12, 0);
}

}  // namespace

void read_body(Section& section, SceneFile& file) {
  PhysicalScene& scene = file.added;
  const std::string name = section.name();
  const std::size_t kind = section.choice("kind", {"rigid", "soft", "static", "moving", "half_space"});
  const bool is_taken = find_named(scene.rigid_bodies, name) || find_named(scene.soft_bodies, name) ||
                        find_named(file.task.objects, name);
  if (is_taken) section.fail("name", "`" + name + "` is taken by a body above");
  if (kind == MOVING)
    scene.rigid_bodies.push_back(read_moving(section, name));
  else if (kind == HALF_SPACE)
    scene.rigid_bodies.push_back(read_half_space(section, name));
  else if (kind == SOFT)
    scene.soft_bodies.push_back(read_soft(section, name));
  else
    scene.rigid_bodies.push_back(read_rigid(section, name, kind == STATIC));
  BodyVisuals visuals;
  (kind == SOFT ? visuals.soft : visuals.rigid) =
      int(kind == SOFT ? scene.soft_bodies.size() : scene.rigid_bodies.size()) - 1;
  visuals.visuals = read_visuals(section);
  if (!visuals.visuals.empty()) file.visuals.push_back(std::move(visuals));
  section.done();
}

void read_joint(Section& section, SceneFile& file) {
  PhysicalScene& scene = file.added;
  Joint joint;
  joint.name = section.name();
  if (find_named(scene.joints, joint.name)) section.fail("name", "`" + joint.name + "` is taken by a joint above");
  joint.type = Joint::Type(section.choice("type", {"fixed", "revolute", "prismatic", "spherical"}));
  const bool turns = joint.type == Joint::Type::revolute, moves = turns || joint.type == Joint::Type::prismatic;
  joint.parent = index_of(section, "parent", scene.rigid_bodies, "rigid or static body");
  joint.child = index_of(section, "child", scene.rigid_bodies, "rigid or static body");
  if (joint.parent == joint.child) section.fail("child", "must not be the parent");
  joint.stiffness = section.number("stiffness", Unit::stiffness, 1e-3, 1e13, joint.stiffness);
  const Unit unit = turns ? Unit::angle : Unit::length;
  const double largest = turns ? LARGEST_ANGLE : REACH;
  if (moves) {
    joint.axis = section.vector("axis", Unit::none, -1e6, 1e6);
    if (!(joint.axis.norm() > 1e-9)) section.fail("axis", "must not have the length zero");
    joint.axis.normalize();
    joint.initial = section.number("initial", unit, -largest, largest, 0);
    if (section.has("limits")) read_limits(section, unit, largest, joint);
    joint.damping = section.number("damping", turns ? Unit::angular_damping : Unit::damping, 0, 1e12, 0);
  }
  joint.parent_frame = read_pose(section, "parent_frame");
  const Pose in_world = scene.rigid_bodies[joint.parent].pose * joint.parent_frame * motion_of(joint, joint.initial);
  const Pose as_started = scene.rigid_bodies[joint.child].pose.inverse() * in_world;
  joint.child_frame = section.has("child_frame") ? read_pose(section, "child_frame") : as_started;
  const Pose apart = as_started.inverse() * joint.child_frame;
  const bool may_turn = joint.type == Joint::Type::spherical;
  if (apart.translation().norm() > START_TOLERANCE ||
      (!may_turn && Eigen::AngleAxisd(apart.linear()).angle() > START_TOLERANCE))
    section.fail("child_frame", "does not meet `parent_frame` at the start; move the bodies, or leave it out");
  if (section.has("drive")) read_drive(section.section("drive"), joint, file);
  section.done();
  scene.joints.push_back(joint);
}

void read_stitch(Section& section, SceneFile& file) {
  PhysicalScene& scene = file.added;
  Stitch stitch;
  if (section.has("soft") == section.has("cloth"))
    section.fail("", "must name either a `soft` body or a `cloth`, which is held");
  if (section.has("soft"))
    stitch.soft = index_of(section, "soft", scene.soft_bodies, "soft body");
  else
    stitch.cloth = index_of_cloth(section, file.task.cloths);
  stitch.rigid = index_of(section, "rigid", scene.rigid_bodies, "rigid or static body");
  stitch.stiffness = section.number("stiffness", Unit::stiffness, 1e-3, 1e13, stitch.stiffness);
  stitch.direction = section.vector("direction", Unit::none, -1e6, 1e6, Vec3::Zero());
  if (section.has("direction") && !(stitch.direction.norm() > 1e-9))
    section.fail("direction", "must not have the length zero; leave it out to hold all directions");
  stitch.nodes = stitch.soft >= 0
                     ? read_points_within(section, scene.soft_bodies[stitch.soft].mesh.points, "soft body")
                     : read_points_within(section, file.task.cloths[stitch.cloth].cloth.mesh.points, "cloth");
  section.done();
  scene.stitches.push_back(stitch);
}

}  // namespace pvg
