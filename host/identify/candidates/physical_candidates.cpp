// Every physical effect of the simulator (host/model/effect.hpp), at every place of the scene where it can act.
#include <algorithm>
#include <set>

#include "host/identify/candidates/candidate.hpp"
#include "host/model/effect.hpp"

namespace pvg::diagnose {
namespace {

// Numbers that only round off a corner of a law; the others that shape a law are fitted with its strengths.
const std::set<std::string> ROUNDING = {"joint_coulomb_friction.velocity", "joint_stribeck_friction.velocity",
                                        "hysteretic_damping.strain_rate", "rolling_resistance.velocity"};

constexpr double FAST_FOR_STOKES = -6;  // log of how likely linear drag is against quadratic
// the same of adhesion that two stiff bodies show: roughness of a micrometre ends even rubber's (Fuller and Tabor 1975)
constexpr double STIFF_FOR_ADHESION = -10;

bool is_fitted(const EffectKind& kind, const EffectParameter& p) {
  return p.is_strength || !ROUNDING.contains(kind.name + "." + p.name);
}

bool may_move(const RigidBody& body) { return !body.is_fixed && !body.is_prescribed && !body.is_half_space; }

double mass_of(const Scene& scene, const std::string& target) {
  for (const RigidBody& body : scene.rigid_bodies)
    if (body.name == target) return body.mass;
  for (const Joint& joint : scene.joints)
    if (joint.name == target) return scene.rigid_bodies[std::size_t(joint.child)].mass;
  return 0.3;
}

// A change worth trying first, from the parameter's unit and the mass of what it acts on.
double scale_of(const EffectParameter& p, double mass) {
  const double weight = 9.81 * mass;
  const std::pair<const char*, double> known[] = {{"N m s/rad", 2e-3 * mass},
                                                  {"N m", 2e-3 * weight},
                                                  {"N m/rad", 1e-2 * weight},
                                                  {"N/m", weight},
                                                  {"N", 0.02 * weight},
                                                  {"N s/m", 0.05 * mass},
                                                  {"N s^2/m^2", 0.05 * mass},
                                                  {"kg", 0.1 * mass},
                                                  {"m", 3e-3},
                                                  {"rad", 0.02},
                                                  {"s", 0.01},
                                                  {"Pa s", 100},
                                                  {"1/s", 0.5},
                                                  {"1/m", 0.2},
                                                  {"J/m^2", 0.1},
                                                  {"s/m", 0.1},
                                                  {"m/s", 0.1},
                                                  {"rad/s", 0.1},
                                                  {"1", 0.1}};
  for (const auto& [unit, scale] : known)
    if (p.unit == unit) return scale;
  return 0.01 * (p.high - p.low);
}

Parameter parameter_of(const EffectParameter& p, double mass) {
  const bool is_limit = p.is_strength && p.off == p.high;
  return {p.name, p.unit,         p.low,   p.high, p.is_strength ? p.off : p.usual, scale_of(p, mass),
          0,      !p.is_strength, is_limit};
}

Candidate candidate_of(const Scene& scene, const EffectKind& kind, const std::string& target) {
  Candidate candidate{
      kind.name, target, Family::physical, kind.site, kind.law, kind.meaning, kind.equation, kind.experiment, {},
      {},        0};
  std::vector<int> place;  // in the effect's parameters
  Effect effect{kind.name, target, {}};
  for (const EffectParameter& p : kind.parameters) {
    effect.parameters.push_back(p.is_strength ? p.off : p.usual);
    if (!is_fitted(kind, p)) continue;
    place.push_back(int(effect.parameters.size()) - 1);
    EffectParameter here = p;
    here.unit = unit_on(scene, target, p.unit);
    candidate.parameters.push_back(parameter_of(here, mass_of(scene, target)));
    if (kind.name == "gravity_tilt") candidate.parameters.back().believed = 0.05;  // of a base that looks level [rad]
    // a spring that pulls a sliding part with more than its weight would be seen
    if (kind.name == "joint_spring" && here.unit == "N")
      candidate.parameters.back().believed = 9.81 * mass_of(scene, target);
    if (kind.name == "constant_force")  // nothing that one sees is pulled by much more of its weight
      candidate.parameters.back().believed = 0.05 * mass_of(scene, target) * scene.gravity.norm();
  }
  candidate.apply = [effect, place](Variant& variant, std::span<const double> values) {
    Effect added = effect;
    for (std::size_t i = 0; i < place.size(); ++i) added.parameters[std::size_t(place[i])] = values[i];
    variant.scene.effects.push_back(added);
  };
  return candidate;
}

std::vector<std::string> targets_of(const Problem& problem, const std::vector<std::string>& touching,
                                    const EffectKind& kind) {
  const Scene& scene = problem.scene.scene;
  std::vector<std::string> targets;
  const auto add_rigid = [&] {
    for (const RigidBody& body : scene.rigid_bodies)
      if (may_move(body)) targets.push_back(body.name);
  };
  switch (kind.target) {
    case EffectTarget::joint:
    case EffectTarget::driven_joint:
      for (const Joint& joint : scene.joints)
        if ((joint.type == Joint::Type::revolute || joint.type == Joint::Type::prismatic) &&
            (kind.target == EffectTarget::joint || is_driven(joint)))
          targets.push_back(joint.name);
      break;
    case EffectTarget::rigid_body:
      add_rigid();
      break;
    case EffectTarget::solid:
      for (const SoftBody& body : scene.soft_bodies) targets.push_back(body.name);
      break;
    case EffectTarget::body:
      add_rigid();
      for (const SoftBody& body : scene.soft_bodies) targets.push_back(body.name);
      for (const Cloth& body : scene.cloths) targets.push_back(body.name);
      break;
    case EffectTarget::deformable:
      for (const SoftBody& body : scene.soft_bodies) targets.push_back(body.name);
      for (const Cloth& body : scene.cloths) targets.push_back(body.name);
      break;
    case EffectTarget::contact:
      for (const std::string& pair : touching) {
        if (kind.name != "rolling_resistance") {
          targets.push_back(pair);
          continue;
        }
        // it brakes the first body, whichever of the two rolls
        const auto [first, second] = sides_of(scene, pair).value();
        const auto rolls = [&](const std::string& name) {
          return std::any_of(scene.rigid_bodies.begin(), scene.rigid_bodies.end(),
                             [&](const RigidBody& body) { return body.name == name && may_move(body); });
        };
        if (rolls(first)) targets.push_back(first + "/" + second);
        if (rolls(second)) targets.push_back(second + "/" + first);
      }
      break;
    case EffectTarget::scene:
      targets.push_back("scene");
      break;
  }
  return targets;
}

bool is_carried(const Scene& scene, const std::string& body) {
  return std::any_of(scene.joints.begin(), scene.joints.end(),
                     [&](const Joint& joint) { return scene.rigid_bodies[std::size_t(joint.child)].name == body; });
}

bool is_there(const Scene& scene, const std::string& name, const std::string& target) {
  return std::any_of(scene.effects.begin(), scene.effects.end(),
                     [&](const Effect& effect) { return effect.name == name && effect.target == target; });
}

bool holds_position(const Scene& scene, const std::string& name) {
  return std::any_of(scene.joints.begin(), scene.joints.end(), [&](const Joint& joint) {
    return joint.name == name && joint.drive.mode == Drive::Mode::position;
  });
}

bool has_soft_side(const Scene& scene, const std::string& contact) {
  const std::array<std::string, 2> sides = sides_of(scene, contact).value();
  const auto is_side = [&](const auto& body) { return body.name == sides[0] || body.name == sides[1]; };
  return std::any_of(scene.soft_bodies.begin(), scene.soft_bodies.end(), is_side) ||
         std::any_of(scene.cloths.begin(), scene.cloths.end(), is_side);
}

}  // namespace

std::vector<CandidateKind> physical_kinds() {
  std::vector<CandidateKind> kinds;
  for (const EffectKind& kind : effect_kinds()) {
    CandidateKind one{kind.name, kind.site, kind.law, kind.meaning, Family::physical, {}};
    for (const EffectParameter& p : kind.parameters) one.parameters.push_back(parameter_of(p, 1));
    kinds.push_back(std::move(one));
  }
  return kinds;
}

void add_physical(const Problem& problem, const std::vector<std::string>& touching, std::vector<Candidate>& out) {
  const Scene& scene = problem.scene.scene;
  for (const EffectKind& kind : effect_kinds())
    for (const std::string& target : targets_of(problem, touching, kind)) {
      if (is_regressed(kind)) continue;  // its formula is not known beforehand
      if (is_there(scene, kind.name, target)) continue;
      if (kind.name == "spin_drag" && is_carried(scene, target)) continue;  // that is its joint's viscous friction
      if (kind.name == "backlash" && !holds_position(scene, target)) continue;
      out.push_back(candidate_of(scene, kind, target));
      // where two explain alike, a carried body is braked by its joint, and a number that is there is wrong
      const bool brakes = kind.name == "linear_drag" || kind.name == "mass_proportional_damping";
      if ((brakes && is_carried(scene, target)) || kind.name == "payload_mass") out.back().prior = -0.5;
      if (kind.target == EffectTarget::contact) out.back().prior = -0.5;  // a wrong coefficient is more common
      if (kind.name == "adhesion" && !has_soft_side(scene, target)) out.back().prior = STIFF_FOR_ADHESION;
      // Stokes' law ends at Reynolds numbers of about 1, a mote in air: what one sees move has quadratic drag
      if (brakes && !is_carried(scene, target)) out.back().prior = FAST_FOR_STOKES;
    }
}

}  // namespace pvg::diagnose
