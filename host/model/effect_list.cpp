#include "host/model/effect_list.hpp"

#include <algorithm>

namespace pvg {
namespace effect_list {
namespace {

template <class List>
auto named(List& list, const std::string& name) {
  return std::find_if(list.begin(), list.end(), [&](const auto& item) { return item.name == name; });
}

bool is_carried(const PhysicalScene& scene, const std::string& body) {
  return std::any_of(scene.joints.begin(), scene.joints.end(),
                     [&](const Joint& joint) { return scene.rigid_bodies[std::size_t(joint.child)].name == body; });
}

bool has_soft_side(const PhysicalScene& scene, const std::string& contact) {
  const std::array<std::string, 2> sides = sides_of(scene, contact).value();
  const auto is_side = [&](const auto& body) { return body.name == sides[0] || body.name == sides[1]; };
  return std::any_of(scene.soft_bodies.begin(), scene.soft_bodies.end(), is_side) ||
         std::any_of(scene.cloths.begin(), scene.cloths.end(), is_side);
}

// Where along the axis a soft body is fastened: the mean of the nodes of its first stitch. Its middle if it is free.
double fastened_at(const PhysicalScene& scene, const SoftBody& body, Eigen::Index axis, double middle) {
  for (const Stitch& stitch : scene.stitches) {
    if (stitch.soft < 0 || &scene.soft_bodies[std::size_t(stitch.soft)] != &body) continue;
    double sum = 0;
    for (const std::uint32_t node : stitch.nodes) sum += body.mesh.points[node][axis];
    return sum / double(stitch.nodes.size());
  }
  return middle;
}

}  // namespace

EffectParameter strength(const char* name, const char* unit, double low, double high, double off) {
  return {name, unit, low, high, off, true, off};
}

EffectParameter shape(const char* name, const char* unit, double low, double high, double usual) {
  return {name, unit, low, high, usual, false, usual};
}

Joint& joint_of(PhysicalScene& scene, const Effect& effect) { return *named(scene.joints, effect.target); }

Drive& drive_of(PhysicalScene& scene, const Effect& effect) { return joint_of(scene, effect).drive; }

RigidBody& rigid_of(PhysicalScene& scene, const Effect& effect) { return *named(scene.rigid_bodies, effect.target); }

Vec3 vector(const Effect& effect) {
  return {parameter_of(effect, "x"), parameter_of(effect, "y"), parameter_of(effect, "z")};
}

void bend_rest_shape(PhysicalScene& scene, const std::string& target, double curvature_1, double curvature_2) {
  SoftBody& body = *named(scene.soft_bodies, target);
  Vec3 low = body.mesh.points[0], high = low;
  for (const Vec3& point : body.mesh.points) {
    low = low.cwiseMin(point);
    high = high.cwiseMax(point);
  }
  Eigen::Index axis = 0;
  (high - low).maxCoeff(&axis);
  const double origin = fastened_at(scene, body, axis, 0.5 * (low[axis] + high[axis]));
  for (Vec3& point : body.mesh.points) {
    const double s = point[axis] - origin;
    point[(axis + 1) % 3] += 0.5 * curvature_1 * s * s;
    point[(axis + 2) % 3] += 0.5 * curvature_2 * s * s;
  }
}

bool holds_position(const PhysicalScene& scene, const std::string& joint) {
  const auto found = named(scene.joints, joint);
  return found != scene.joints.end() && found->drive.mode == Drive::Mode::position;
}

bool is_not_carried(const PhysicalScene& scene, const std::string& body) { return !is_carried(scene, body); }

bool is_never_missing(const PhysicalScene&, const std::string&) { return false; }

bool has_no_armature(const PhysicalScene& scene, const std::string& joint) {
  const auto found = named(scene.joints, joint);
  return found != scene.joints.end() && found->armature == 0;
}

// where two explain alike, a number of the scene is wrong more often
double less_common(const PhysicalScene&, const std::string&) { return -0.5; }

// A carried body is more often braked by its joint. Stokes' law ends at Reynolds numbers of about 1, a mote in air:
// what one sees move has quadratic drag.
double rare_in_sight(const PhysicalScene& scene, const std::string& body) {
  return is_carried(scene, body) ? -0.5 : -6;
}

// roughness of a micrometre ends even rubber's adhesion (Fuller and Tabor 1975)
double rare_between_stiff_bodies(const PhysicalScene& scene, const std::string& contact) {
  return has_soft_side(scene, contact) ? -0.5 : -10;
}

double tilt_of_a_level_base(const PhysicalScene&, const std::string&, double) { return 0.05; }  // [rad]

// a spring that pulls a sliding part with more than its weight would be seen
double weight_of_what_slides(const PhysicalScene&, const std::string& unit, double mass) {
  return unit == "N" ? 9.81 * mass : 0;
}

// nothing that one sees is pulled by much more of its weight
double part_of_the_weight(const PhysicalScene& scene, const std::string&, double mass) {
  return 0.05 * mass * scene.gravity.norm();
}

}  // namespace effect_list

const std::vector<EffectRow>& effect_rows() {
  using namespace effect_list;
  static const std::vector<EffectRow> ROWS = [] {
    std::vector<EffectRow> all;
    for (const std::vector<EffectRow>& part :
         {joint_effects(), body_effects(), solid_effects(), contact_effects(), regressed_effects()})
      all.insert(all.end(), part.begin(), part.end());
    return all;
  }();
  return ROWS;
}

const EffectRow& effect_row(const std::string& name) {
  return effect_rows()[std::size_t(&effect_kind(name) - effect_kinds().data())];
}

const std::vector<EffectKind>& effect_kinds() {
  static const std::vector<EffectKind> KINDS = [] {
    std::vector<EffectKind> kinds;
    for (const EffectRow& row : effect_rows()) kinds.push_back(row.kind);
    return kinds;
  }();
  return KINDS;
}

bool is_regressed(const EffectKind& kind) { return kind.law == effect_list::REGRESSED; }

}  // namespace pvg
