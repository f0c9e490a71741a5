// Every physical effect of the simulator (host/model/effect.hpp), at every place of the scene where it can act.
#include <algorithm>
#include <cmath>

#include "host/identify/candidates/candidate.hpp"
#include "host/identify/criteria.hpp"
#include "host/model/effect_row.hpp"

namespace pvg::diagnose {
namespace {

double mass_of(const PhysicalScene& scene, const std::string& target) {
  for (const RigidBody& body : scene.rigid_bodies)
    if (body.name == target) return body.mass;
  for (const Joint& joint : scene.joints)
    if (joint.name == target) return scene.rigid_bodies[std::size_t(joint.child)].mass;
  return criteria().change_unknown_mass;
}

// A change worth trying first, from the parameter's unit and the mass of what it acts on.
double scale_of(const EffectParameter& p, double mass) {
  const double weight = 9.81 * mass;
  const Criteria& c = criteria();
  const std::pair<const char*, double> known[] = {{"N m s/rad", c.change_joint_damping * mass},
                                                  {"N m", c.change_torque * weight},
                                                  {"N m/rad", c.change_joint_stiffness * weight},
                                                  {"N/m", c.change_stiffness * weight},
                                                  {"N", c.change_force * weight},
                                                  {"N s/m", c.change_drag * mass},
                                                  {"N s^2/m^2", c.change_drag * mass},
                                                  {"kg", c.change_mass * mass},
                                                  {"kg m^2", c.change_rotor_inertia * mass},
                                                  {"m", c.change_shift},
                                                  {"rad", c.change_turn},
                                                  {"s", c.change_time},
                                                  {"Pa s", c.change_viscosity},
                                                  {"1/s", c.change_decay},
                                                  {"1/m", c.change_curvature},
                                                  {"J/m^2", c.change_adhesion},
                                                  {"s/m", c.change_dissipation},
                                                  {"m/s", c.change_speed},
                                                  {"rad/s", c.change_spin},
                                                  {"1", c.change_share}};
  for (const auto& [unit, scale] : known)
    if (p.unit == unit) return scale;
  return c.change_other * (p.high - p.low);
}

// A shape parameter lies anywhere between its bounds, which are factors apart.
Parameter parameter_of(const EffectParameter& p, double mass) {
  Parameter out{p.name, p.unit, p.low, p.high, p.is_strength ? p.off : p.usual, scale_of(p, mass)};
  out.is_shape = !p.is_strength;
  out.is_limit = p.is_strength && p.off == p.high;
  out.is_logarithmic = out.is_shape && p.low > 0;
  return out;
}

// The rate below which the friction of a joint is rounded off. Stuck it creeps at up to that rate, and a reversal
// leaves its rate wrong by some of it, which must not be seen:
//   eps = s min(sigma_q / T, sigma_v)   [rad/s, m/s]
// with T the longest run, sigma_q the noise of places and turns, sigma_v that of rates, s a share.
double unseen_rate(const Problem& problem) {
  double longest = 0, least = INFINITY;
  for (const Run& run : problem.runs) longest = std::max(longest, run.t.back() - run.t.front());
  for (const Channel& channel : problem.channels) {
    const StartRole role = channel.sensor->start;
    if (role == StartRole::nothing || channel.sigma <= 0) continue;
    least = std::min(least, role == StartRole::rate ? channel.sigma : channel.sigma / longest);
  }
  return criteria().rounding_rate_share * least;
}

Candidate candidate_of(const Problem& problem, const EffectRow& row, const std::string& target) {
  const PhysicalScene& scene = problem.scene.scene;
  const EffectKind& kind = row.kind;
  Candidate candidate{
      kind.name, target, Family::physical, kind.site, kind.law, kind.meaning, kind.equation, kind.experiment, {},
      {},        0};
  std::vector<int> place;  // in the effect's parameters
  Effect effect{kind.name, target, {}};
  for (const EffectParameter& p : kind.parameters) {
    effect.parameters.push_back(p.is_strength ? p.off : p.usual);
    if (row.rounding != nullptr && p.name == row.rounding) {
      if (kind.target == EffectTarget::joint)
        effect.parameters.back() = std::clamp(unseen_rate(problem), p.low, p.usual);
      continue;
    }
    place.push_back(int(effect.parameters.size()) - 1);
    EffectParameter here = p;
    here.unit = unit_on(scene, target, p.unit);
    candidate.parameters.push_back(parameter_of(here, mass_of(scene, target)));
    if (row.prior_sigma != nullptr) {
      candidate.parameters.back().prior_sigma = row.prior_sigma(scene, here.unit, mass_of(scene, target));
      candidate.parameters.back().prior_is_habit = true;
    }
  }
  candidate.apply = [effect, place](Variant& variant, std::span<const double> values) {
    Effect added = effect;
    for (std::size_t i = 0; i < place.size(); ++i) added.parameters[std::size_t(place[i])] = values[i];
    variant.scene.effects.push_back(added);
  };
  candidate.amend = amend_last_effect;
  candidate.log_prior = row.log_prior != nullptr ? row.log_prior(scene, target) : 0;
  return candidate;
}

std::vector<std::string> targets_of(const Problem& problem, const std::vector<std::string>& touching,
                                    const EffectRow& row) {
  const PhysicalScene& scene = problem.scene.scene;
  std::vector<std::string> targets;
  const auto add_rigid = [&] {
    for (const RigidBody& body : scene.rigid_bodies)
      if (can_move(body)) targets.push_back(body.name);
  };
  switch (row.kind.target) {
    case EffectTarget::joint:
    case EffectTarget::driven_joint:
      for (const Joint& joint : scene.joints)
        if ((joint.type == Joint::Type::revolute || joint.type == Joint::Type::prismatic) &&
            (row.kind.target == EffectTarget::joint || is_driven(joint)))
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
        if (!row.acts_on_first) {
          targets.push_back(pair);
          continue;
        }
        // whichever of the two moves
        const auto [first, second] = sides_of(scene, pair).value();
        const auto rolls = [&](const std::string& name) {
          return std::any_of(scene.rigid_bodies.begin(), scene.rigid_bodies.end(),
                             [&](const RigidBody& body) { return body.name == name && can_move(body); });
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

bool is_there(const PhysicalScene& scene, const std::string& name, const std::string& target) {
  return std::any_of(scene.effects.begin(), scene.effects.end(),
                     [&](const Effect& effect) { return effect.name == name && effect.target == target; });
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
  const PhysicalScene& scene = problem.scene.scene;
  for (const EffectRow& row : effect_rows()) {
    if (is_regressed(row.kind)) continue;  // its formula is not known beforehand
    for (const std::string& target : targets_of(problem, touching, row))
      if (!is_there(scene, row.kind.name, target) && (row.is_possible == nullptr || row.is_possible(scene, target)))
        out.push_back(candidate_of(problem, row, target));
  }
}

}  // namespace pvg::diagnose
