#include "host/physics/energies/joint.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "host/model/effect_row.hpp"
#include "host/physics/energies/joint_anchors.hpp"
#include "host/physics/energies/laws.hpp"

namespace pvg {
namespace {

constexpr double LOCK_LEVER = 0.1;  // of the springs that hold directions together [m]

// axis t, and n, b with t = n x b, in the joint frame
Mat3 joint_triad(const Joint& joint) {
  const Vec3 t = joint.axis.normalized();
  const Vec3 n = t.unitOrthogonal();
  Mat3 triad;
  triad << n, t.cross(n), t;
  return triad;
}

void add_anchor(System& system, std::size_t world, const Joint& joint, const Vec3& point) {
  system.zero_length_spring.rows.push_back({{add_point_site(system, world, joint.parent, joint.parent_frame * point),
                                             add_point_site(system, world, joint.child, joint.child_frame * point)},
                                            joint.stiffness});
}

void add_direction_lock(System& system, std::size_t world, const Joint& joint, const Vec3& direction) {
  system.zero_length_spring.rows.push_back(
      {{add_direction_site(system, world, joint.parent, joint.parent_frame.linear() * direction),
        add_direction_site(system, world, joint.child, joint.child_frame.linear() * direction)},
       joint.stiffness * LOCK_LEVER * LOCK_LEVER});
}

// (c_j - c_i) . d_i under the law of a drive
PrismaticDrive offset_row(System& system, std::size_t world, const Joint& joint, const Vec3& direction) {
  PrismaticDrive row{};
  row.site[0] = add_point_site(system, world, joint.parent, joint.parent_frame.translation());
  row.site[1] = add_point_site(system, world, joint.child, joint.child_frame.translation());
  row.site[2] = add_direction_site(system, world, joint.parent, joint.parent_frame.linear() * direction);
  return row;
}

// directions n and b of parent and child
void set_revolute_sites(System& system, std::size_t world, const Joint& joint, const Mat3& triad, u32 site[4]) {
  for (int k = 0; k < 2; ++k) {
    site[k] = add_direction_site(system, world, joint.parent, joint.parent_frame.linear() * triad.col(k));
    site[2 + k] = add_direction_site(system, world, joint.child, joint.child_frame.linear() * triad.col(k));
  }
}

// a drive's row, without the numbers of a step; it also holds the joint's own damping
int add_drive(System& system, std::size_t world, const Joint& joint, const Mat3& triad) {
  const auto add = [&](auto& rows, auto row) {
    row.damping = joint.damping;
    row.effort_limit = joint.drive.effort_limit;
    rows.push_back(row);
    return int(rows.size()) - 1;
  };
  if (joint.type == Joint::Type::prismatic)
    return add(system.prismatic_drive.rows, offset_row(system, world, joint, triad.col(2)));
  RevoluteDrive row{};
  set_revolute_sites(system, world, joint, triad, row.site);
  return add(system.revolute_drive.rows, row);
}

double stop_stiffness(const Joint& joint) {
  if (joint.limit_stiffness > 0) return joint.limit_stiffness;
  return joint.type == Joint::Type::prismatic ? 1e6 : 1e5;
}

bool has_limits(const Joint& joint) { return joint.lower != 0 || joint.upper != 0; }

int add_limit(System& system, std::size_t world, const Joint& joint, const Mat3& triad) {
  const auto add = [&](auto& rows, auto row) {
    row.stiffness = stop_stiffness(joint);
    row.lower = joint.lower;
    row.upper = joint.upper;
    rows.push_back(row);
    return int(rows.size()) - 1;
  };
  if (joint.type == Joint::Type::prismatic) {
    PrismaticLimit row{};
    std::copy_n(offset_row(system, world, joint, triad.col(2)).site, 3, row.site);
    return add(system.prismatic_limit.rows, row);
  }
  RevoluteLimit row{};
  set_revolute_sites(system, world, joint, triad, row.site);
  return add(system.revolute_limit.rows, row);
}

// the row of an effect on a joint, without its numbers
template <class Row>
int fill_effect(Rows<Row>& rows, Row row, const Effect& effect, double h) {
  row.rate_length = h;
  JointNumbers numbers;
  add_numbers(effect, numbers);
  row.damping = numbers.damping;
  row.stiffness = numbers.stiffness;
  row.preload = numbers.preload;
  row.coulomb = numbers.coulomb;
  row.extra = numbers.extra;
  row.velocity = numbers.velocity;
  row.stribeck_velocity = numbers.stribeck_velocity;
  rows.rows.push_back(row);
  return int(rows.rows.size()) - 1;
}

int add_effect(System& system, std::size_t world, const Joint& joint, const Mat3& triad, const Effect& effect) {
  const double h = system.scenes[world].solver.time_step;
  if (joint.type == Joint::Type::prismatic) {
    PrismaticEffect row{};
    std::copy_n(offset_row(system, world, joint, triad.col(2)).site, 3, row.site);
    return fill_effect(system.prismatic_effect, row, effect, h);
  }
  RevoluteEffect row{};
  set_revolute_sites(system, world, joint, triad, row.site);
  return fill_effect(system.revolute_effect, row, effect, h);
}

int add_law(System& system, std::size_t world, const Joint& joint, const Mat3& triad, const Effect& effect) {
  const auto add = [&](auto& rows, auto row) {
    row.rate_length = system.scenes[world].solver.time_step;
    row.law = number_of(system.joint_laws, law_of(effect)[0].kernel_text);
    std::copy(effect.parameters.begin(), effect.parameters.end(), row.coefficient);
    rows.push_back(row);
    return int(rows.size()) - 1;
  };
  if (joint.type == Joint::Type::prismatic) {
    PrismaticLaw row{};
    std::copy_n(offset_row(system, world, joint, triad.col(2)).site, 3, row.site);
    return add(system.prismatic_law.rows, row);
  }
  RevoluteLaw row{};
  set_revolute_sites(system, world, joint, triad, row.site);
  return add(system.revolute_law.rows, row);
}

// what acts along the coordinate of a revolute or prismatic joint
JointRows add_coordinate_rows(System& system, std::size_t world, const Joint& joint, const Mat3& triad) {
  JointRows rows;
  if (is_driven(joint) || joint.damping > 0 || joint.armature > 0) rows.drive = add_drive(system, world, joint, triad);
  if (has_limits(joint)) rows.limit = add_limit(system, world, joint, triad);
  for (const Effect& effect : system.scenes[world].effects) {
    const EffectKind& kind = effect_kind(effect.name);
    if (effect.target != joint.name || kind.target != EffectTarget::joint) continue;
    if (is_regressed(kind))
      rows.laws.push_back(add_law(system, world, joint, triad, effect));
    else
      rows.effects.push_back(add_effect(system, world, joint, triad, effect));
  }
  return rows;
}

void check_joint(const PhysicalScene& scene, const Joint& joint) {
  const int n = int(scene.rigid_bodies.size());
  if (joint.parent < 0 || joint.child < 0 || joint.parent >= n || joint.child >= n || joint.parent == joint.child)
    throw UsageError("joint " + joint.name + " must join two different rigid bodies");
  if (!(joint.axis.norm() > 0)) throw UsageError("joint " + joint.name + " has an axis of length zero");
  if (!(joint.stiffness > 0) || joint.drive.stiffness < 0 || joint.drive.damping < 0 || joint.damping < 0)
    throw UsageError("joint " + joint.name + ": stiffness must be positive, the drive's and damping not negative");
  if (joint.armature < 0) throw UsageError("joint " + joint.name + " has an armature below 0; give 0 or more");
  if (joint.lower > joint.upper) throw UsageError("joint " + joint.name + ": its lower limit is above the upper one");
}

}  // namespace

void add_joints(System& system, std::size_t world) {
  const PhysicalScene& scene = system.scenes[world];
  system.joint_rows.emplace_back(scene.joints.size());
  for (std::size_t j = 0; j < scene.joints.size(); ++j) {
    const Joint& joint = scene.joints[j];
    check_joint(scene, joint);
    const Mat3 triad = joint_triad(joint);
    switch (joint.type) {
      case Joint::Type::spherical:
      case Joint::Type::fixed:
        for (const Vec3& anchor : joint_anchors(joint)) add_anchor(system, world, joint, anchor);
        break;
      case Joint::Type::revolute:
        for (const Vec3& anchor : joint_anchors(joint)) add_anchor(system, world, joint, anchor);
        system.joint_rows[world][j] = add_coordinate_rows(system, world, joint, triad);
        break;
      case Joint::Type::prismatic:
        for (int k = 0; k < 3; ++k) add_direction_lock(system, world, joint, triad.col(k));
        for (int k = 0; k < 2; ++k) {
          PrismaticDrive guide = offset_row(system, world, joint, triad.col(k));
          guide.stiffness = joint.stiffness;
          system.prismatic_drive.rows.push_back(guide);
        }
        system.joint_rows[world][j] = add_coordinate_rows(system, world, joint, triad);
        break;
    }
  }
}

double joint_coordinate(const Joint& joint, const AffineMap& parent, const AffineMap& child) {
  const Mat3 triad = joint_triad(joint);
  const Mat3 i = parent.leftCols<3>() * joint.parent_frame.linear() * triad;
  const Mat3 j = child.leftCols<3>() * joint.child_frame.linear() * triad;
  if (joint.type == Joint::Type::revolute)
    return std::atan2(j.col(0).dot(i.col(1)) - j.col(1).dot(i.col(0)), i.col(0).dot(j.col(0)) + i.col(1).dot(j.col(1)));
  if (joint.type == Joint::Type::prismatic) {
    const auto centre = [](const AffineMap& map, const Pose& frame) -> Vec3 {
      return map.leftCols<3>() * frame.translation() + map.col(3);
    };
    return (centre(child, joint.child_frame) - centre(parent, joint.parent_frame)).dot(i.col(2));
  }
  return 0;
}

double unwrap_angle(double angle, double near) {
  const double turn = 2 * std::numbers::pi;
  return angle + turn * std::round((near - angle) / turn);
}

StepDrive drive_over_step(const Drive& drive, double start, double target, double change, double weight, double h) {
  const double per_length = drive.damping / h, gain = drive.gain;
  if (drive.mode == Drive::Mode::position && drive.damped_rate == Drive::DampedRate::joint) change = 0;
  switch (drive.mode) {
    case Drive::Mode::velocity:
      return {gain * per_length, start + h * target, gain * weight};
    case Drive::Mode::torque:
      return {0, 0, gain * (weight + target)};
    default: {
      if (drive.play > 0)
        return {gain * drive.stiffness, target, gain * weight, drive.play, gain * drive.damping, change};
      const double stiffness = drive.stiffness + per_length;
      return {gain * stiffness, target + per_length / stiffness * (start + change - target), gain * weight};
    }
  }
}

double drive_effort(const StepDrive& drive, double effort_limit, double q, double rate, double h) {
  double effort = drive.feed_forward;
  if (drive.stiffness > 0) {
    const double error = drive.target + drive.feed_forward / drive.stiffness - q;
    effort = drive.stiffness * (error - std::clamp(error, -drive.play / 2, drive.play / 2));
    if (drive.damping > 0) effort -= drive.damping * (rate - drive.change / h);
  }
  return effort_limit > 0 ? std::clamp(effort, -effort_limit, effort_limit) : effort;
}

StepMotion with_armature(StepMotion motion, double armature, double foreseen, double h, double inertia_h) {
  if (armature == 0) return motion;
  const double damping = armature * h / (inertia_h * inertia_h);
  const double sum = motion.damping + damping;
  return {sum, (motion.damping * motion.change + damping * foreseen) / sum};
}

double stop_effort(const Joint& joint, double q) {
  if (!has_limits(joint)) return 0;
  return -stop_stiffness(joint) * (std::max(q - joint.upper, 0.0) + std::min(q - joint.lower, 0.0));
}

std::vector<Carried> carried_bodies(const PhysicalScene& scene) {
  std::vector<Carried> carried(scene.joints.size());
  for (std::size_t j = 0; j < scene.joints.size(); ++j) {
    std::vector<int>& rigid = carried[j].rigid;
    rigid.push_back(scene.joints[j].child);
    for (std::size_t k = 0; k < rigid.size(); ++k)  // grows while it runs; each body enters once
      for (const Joint& next : scene.joints)
        if (next.parent == rigid[k] && std::find(rigid.begin(), rigid.end(), next.child) == rigid.end())
          rigid.push_back(next.child);
    for (const Stitch& stitch : scene.stitches)
      if (stitch.soft >= 0 && std::find(rigid.begin(), rigid.end(), stitch.rigid) != rigid.end() &&
          std::find(carried[j].soft.begin(), carried[j].soft.end(), stitch.soft) == carried[j].soft.end())
        carried[j].soft.push_back(stitch.soft);
  }
  return carried;
}

double gravity_feed_forward(const PhysicalScene& scene, const Joint& joint, const Carried& carried,
                            const SceneState& state, std::span<const std::vector<double>> soft_masses) {
  const AffineMap& parent = state.rigid[joint.parent];
  const Vec3 axis = (parent.leftCols<3>() * joint.parent_frame.linear() * joint.axis).normalized();
  const Vec3 centre = parent.leftCols<3>() * joint.parent_frame.translation() + parent.col(3);
  double weight_along = 0;
  const auto add = [&](double mass, const Vec3& x) {
    const Vec3 motion = joint.type == Joint::Type::revolute ? axis.cross(x - centre) : axis;
    weight_along += mass * scene.gravity.dot(motion);
  };
  for (const int b : carried.rigid) {
    const RigidBody& body = scene.rigid_bodies[b];
    add(body.mass, state.rigid[b].leftCols<3>() * body.center_of_mass + state.rigid[b].col(3));
  }
  for (const int b : carried.soft)
    for (std::size_t i = 0; i < soft_masses[b].size(); ++i) add(soft_masses[b][i], state.soft[b][i]);
  return -weight_along;
}

}  // namespace pvg
