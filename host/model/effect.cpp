#include "host/model/effect.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "host/base/error.hpp"
#include "host/model/physical_scene.hpp"

namespace pvg {
namespace {

const char* const REGRESSED = "regressed";  // the law of those that are given by formulas

EffectParameter strength(const char* name, const char* unit, double low, double high, double off = 0) {
  return {name, unit, low, high, off, true, off};
}

EffectParameter shape(const char* name, const char* unit, double low, double high, double usual) {
  return {name, unit, low, high, usual, false, usual};
}

std::vector<EffectKind> joint_kinds() {
  using T = EffectTarget;
  return {
      {"joint_viscous_friction",
       T::joint,
       "joint rate",
       "quadratic",
       "a bearing resists in proportion to its rate",
       "effort = -damping q'",
       "a free swing: the amplitude falls exponentially",
       {strength("damping", "N m s/rad", 0, 1e3)}},
      {"joint_coulomb_friction",
       T::joint,
       "joint rate",
       "smoothed Coulomb",
       "a bearing resists alike at every rate",
       "effort = -effort sign(q')",
       "a free swing: the amplitude falls by the same angle each time",
       {strength("effort", "N m", 0, 1e3), shape("velocity", "rad/s", 1e-6, 1, 1e-3)}},
      {"joint_stribeck_friction",
       T::joint,
       "joint rate",
       "Stribeck",
       "a bearing sticks harder than it slides",
       "effort = -(effort + extra exp(-(q'/stribeck_velocity)^2)) sign(q')",
       "slow and fast strokes and a reversal",
       {strength("effort", "N m", 0, 1e3), strength("extra", "N m", 0, 1e3),
        shape("stribeck_velocity", "rad/s", 1e-3, 100, 0.1), shape("velocity", "rad/s", 1e-6, 1, 1e-3)}},
      {"backlash",
       T::driven_joint,
       "joint position",
       "dead zone",
       "the drive is loose by a play before it takes hold",
       "effort = stiffness (e - clamp(e, -play/2, play/2)), e = target - q",
       "a slow reversal under both signs of load",
       {strength("play", "rad", 0, 1)}},
      {"joint_spring",
       T::joint,
       "joint position",
       "linear and quadratic",
       "a spring, such as a door closer, pulls back",
       "effort = preload - stiffness q",
       "a release from two positions",
       {strength("stiffness", "N m/rad", 0, 1e4), strength("preload", "N m", -1e3, 1e3)}},
      {"actuator_lag",
       T::driven_joint,
       "command",
       "first-order lag",
       "the drive follows its command late and smoothly",
       "command' = (given - command) / time_constant",
       "a step and a chirp",
       {strength("time_constant", "s", 0, 1)}},
      {"actuator_delay",
       T::driven_joint,
       "command",
       "delay",
       "the drive obeys its command some time later",
       "command(t) = given(t - delay)",
       "a step",
       {strength("delay", "s", 0, 1)}},
      {"actuator_gain",
       T::driven_joint,
       "drive",
       "scale",
       "the drive gives more or less effort than it should",
       "effort = gain x effort of the drive",
       "a static load at two efforts",
       {strength("gain", "1", 0, 5, 1)}},
  };
}

std::vector<EffectKind> body_kinds() {
  using T = EffectTarget;
  return {
      {"payload_mass",
       T::rigid_body,
       "inertia",
       "constant",
       "something is fastened to the body at its centre of mass",
       "mass = given + mass",
       "two poses and an acceleration",
       {strength("mass", "kg", -0.9, 100)}},
      {"center_of_mass_offset",
       T::rigid_body,
       "inertia",
       "constant",
       "the centre of mass is elsewhere, body frame",
       "c = given + (x, y, z)",
       "rest torque in two poses",
       {strength("x", "m", -1, 1), strength("y", "m", -1, 1), strength("z", "m", -1, 1)}},
      {"gravity_tilt",
       T::scene,
       "gravity",
       "rotation",
       "the base does not stand level",
       "g = R_y(about_y) R_x(about_x) g_given",
       "free motion in two directions",
       {strength("about_x", "rad", -0.5, 0.5), strength("about_y", "rad", -0.5, 0.5)}},
      {"linear_drag",
       T::body,
       "body velocity",
       "quadratic",
       "the surroundings resist in proportion to speed",
       "F = -drag v",
       "two speeds",
       {strength("drag", "N s/m", 0, 1e3)}},
      {"quadratic_drag",
       T::body,
       "body velocity",
       "cubic",
       "air resists with the square of speed",
       "F = -drag |v| v",
       "two speeds, a heavy body as control",
       {strength("drag", "N s^2/m^2", 0, 1e3)}},
      {"constant_force",
       T::body,
       "body position",
       "linear",
       "a steady force, such as wind, world frame",
       "F = (x, y, z)",
       "a flight or a rest beside the same without it",
       {strength("x", "N", -1e4, 1e4), strength("y", "N", -1e4, 1e4), strength("z", "N", -1e4, 1e4)}},
      {"spin_drag",
       T::rigid_body,
       "body spin",
       "quadratic",
       "the surroundings resist turning",
       "torque = -drag omega",
       "a free spin",
       {strength("drag", "N m s/rad", 0, 100)}},
  };
}

std::vector<EffectKind> solid_kinds() {
  using T = EffectTarget;
  return {
      {"kelvin_voigt_damping",
       T::solid,
       "element strain rate",
       "quadratic",
       "the material is viscous beside its elasticity",
       "S = 2 viscosity E'",
       "ringing with two tip masses: high tones die sooner",
       {strength("viscosity", "Pa s", 0, 1e6)}},
      {"mass_proportional_damping",
       T::deformable,
       "vertex velocity",
       "quadratic",
       "every particle is braked alike",
       "F_i = -rate m_i v_i",
       "ringing with two tip masses: all tones die alike",
       {strength("rate", "1/s", 0, 1e3)}},
      {"hysteretic_damping",
       T::solid,
       "element strain rate",
       "smoothed Coulomb",
       "the material loses the same share of its energy in every cycle, fast or slow",
       "S = 2 mu loss |E| E'/|E'|",
       "ringing with two tip masses at one amplitude",
       {strength("loss", "1", 0, 2), shape("strain_rate", "1/s", 1e-6, 1, 1e-3)}},
      {"strain_stiffening",
       T::solid,
       "element strain",
       "quartic",
       "the material stiffens as it is strained",
       "S = 4 mu stiffening (E:E) E",
       "two amplitudes",
       {strength("stiffening", "1", 0, 1e4)}},
      {"rest_shape_error",
       T::solid,
       "rest shape",
       "curvature",
       "the body is bent when nothing acts on it",
       "along its longest axis s from where it is fastened (else its middle), across it: + curvature s^2 / 2",
       "the same body turned over",
       {strength("curvature_1", "1/m", -20, 20), strength("curvature_2", "1/m", -20, 20)}},
      {"plastic_yield",
       T::solid,
       "element strain",
       "yield",
       "strained beyond a limit it stays bent",
       "|dev log U| > yield_strain flows",
       "load, unload, wait: some of the bend stays at once",
       {{"yield_strain", "1", 1e-4, 10, 10, true, 10}}},
      {"creep",
       T::solid,
       "element strain",
       "Maxwell flow",
       "held under load it gives way slowly",
       "(dev log U)' = -rate dev log U",
       "load, hold, unload, wait: the bend grows with time",
       {strength("rate", "1/s", 0, 10)}},
  };
}

std::vector<EffectKind> contact_kinds() {
  using T = EffectTarget;
  return {
      {"velocity_dependent_friction",
       T::contact,
       "contact slip",
       "Stribeck",
       "sliding friction differs from that at rest",
       "mu(v) = mu (1 + change (1 - exp(-v/velocity)))",
       "slides at two speeds",
       {strength("change", "1", -0.95, 5), shape("velocity", "m/s", 1e-4, 10, 0.1)}},
      {"anisotropic_friction",
       T::contact,
       "contact slip",
       "smoothed Coulomb",
       "friction differs by direction, first body's x",
       "mu = mu_given sqrt(cos^2 + (1 + change)^2 sin^2) of the angle from x",
       "slides in two directions",
       {strength("change", "1", -0.95, 50)}},
      {"adhesion",
       T::contact,
       "contact gap",
       "attraction",
       "the surfaces stick together",
       "energy per area = -energy (1 - g/d)^2 (1 + 2 g/d), g: gap below d",
       "a pull-off",
       {strength("energy", "J/m^2", 0, 1e3)}},
      {"contact_dissipation",
       T::contact,
       "contact gap rate",
       "quadratic",
       "a touch takes energy from an impact",
       "N = N_elastic (1 - dissipation g')",
       "two drop heights",
       {strength("dissipation", "s/m", 0, 1e3)}},
      {"rolling_resistance",
       T::contact,
       "body spin",
       "smoothed Coulomb",
       "a rolling body is braked by what it presses on",
       "torque = -arm N omega/|omega| on the first body",
       "a roll-out at two speeds",
       {strength("arm", "m", 0, 0.1), shape("velocity", "rad/s", 1e-6, 1, 1e-2)}},
  };
}

std::vector<EffectKind> regressed_kinds() {
  using T = EffectTarget;
  return {
      {"regressed_effort",
       T::joint,
       "joint position and rate",
       REGRESSED,
       "a law of the joint's position and rate that a regression found",
       "effort = formula(q, v), v = q'",
       "free swings from several amplitudes",
       {}},
      {"regressed_force",
       T::rigid_body,
       "body position and velocity",
       REGRESSED,
       "a law of the body's place and velocity that a regression found, at its centre of mass, world frame",
       "F = formulas(x, y, z, vx, vy, vz)",
       "flights through several places at several speeds",
       {}},
  };
}

std::vector<EffectKind> all_kinds() {
  std::vector<EffectKind> all;
  for (const std::vector<EffectKind>& part :
       {joint_kinds(), body_kinds(), solid_kinds(), contact_kinds(), regressed_kinds()})
    all.insert(all.end(), part.begin(), part.end());
  return all;
}

template <class List>
bool holds(const List& list, const std::string& name) {
  return std::any_of(list.begin(), list.end(), [&](const auto& item) { return item.name == name; });
}

bool is_body(const PhysicalScene& scene, const std::string& name) {
  return holds(scene.rigid_bodies, name) || holds(scene.soft_bodies, name) || holds(scene.cloths, name);
}

// empty: it is there; else what must be named
std::string lacking(const PhysicalScene& scene, const EffectKind& kind, const std::string& target) {
  switch (kind.target) {
    case EffectTarget::joint:
    case EffectTarget::driven_joint:
      for (const Joint& joint : scene.joints)
        if (joint.name == target && (joint.type == Joint::Type::revolute || joint.type == Joint::Type::prismatic) &&
            (kind.target == EffectTarget::joint || is_driven(joint)))
          return "";
      return kind.target == EffectTarget::joint ? "a revolute or prismatic joint" : "a joint with a drive";
    case EffectTarget::rigid_body:
      return holds(scene.rigid_bodies, target) ? "" : "a rigid body";
    case EffectTarget::solid:
      return holds(scene.soft_bodies, target) ? "" : "a soft body";
    case EffectTarget::deformable:
      return holds(scene.soft_bodies, target) || holds(scene.cloths, target) ? "" : "a soft body or cloth";
    case EffectTarget::body:
      return is_body(scene, target) ? "" : "a body";
    case EffectTarget::contact:
      return sides_of(scene, target) ? "" : "two bodies as FIRST/SECOND";
    case EffectTarget::scene:
      return target == "scene" ? "" : "`scene`";
  }
  return "";
}

}  // namespace

const std::vector<EffectKind>& effect_kinds() {
  static const std::vector<EffectKind> KINDS = all_kinds();
  return KINDS;
}

const EffectKind& effect_kind(const std::string& name) {
  std::string known;
  for (const EffectKind& kind : effect_kinds()) {
    if (kind.name == name) return kind;
    known += (known.empty() ? "" : ", ") + kind.name;
  }
  throw UsageError("there is no effect `" + name + "`; there are: " + known);
}

bool is_regressed(const EffectKind& kind) { return kind.law == REGRESSED; }

std::vector<std::string> law_variables(const EffectKind& kind) {
  if (kind.target == EffectTarget::joint) return {"q", "v"};
  return {"x", "y", "z", "vx", "vy", "vz"};
}

std::size_t n_formulas(const EffectKind& kind) {
  if (!is_regressed(kind)) return 0;
  return kind.target == EffectTarget::joint ? 1 : 3;
}

std::vector<Formula> law_of(const Effect& effect) {
  const EffectKind& kind = effect_kind(effect.name);
  const std::string who = "effect " + effect.name + " on " + effect.target;
  if (effect.formulas.size() != n_formulas(kind))
    throw UsageError(who + " needs " + std::to_string(n_formulas(kind)) + " formulas, but has " +
                     std::to_string(effect.formulas.size()));
  if (effect.parameters.size() > MOST_COEFFICIENTS)
    throw UsageError(who + " may have " + std::to_string(MOST_COEFFICIENTS) + " coefficients, but has " +
                     std::to_string(effect.parameters.size()));
  for (const double c : effect.parameters)
    if (!std::isfinite(c)) throw UsageError(who + ": a coefficient is not finite");
  std::vector<Formula> law;
  for (const std::string& text : effect.formulas) {
    const std::string formula = who + ": formula `" + text + "` ";
    try {
      law.push_back(parse_formula(text, law_variables(kind)));
    } catch (const UsageError& error) {
      throw UsageError(formula + "is wrong " + error.what());
    }
    if (law.back().n_coefficients > effect.parameters.size())
      throw UsageError(formula + "uses c" + std::to_string(law.back().n_coefficients - 1) + ", but there are " +
                       std::to_string(effect.parameters.size()) + " coefficients");
  }
  return law;
}

double parameter_of(const Effect& effect, const std::string& name) {
  const std::vector<EffectParameter>& parameters = effect_kind(effect.name).parameters;
  for (std::size_t i = 0; i < parameters.size(); ++i)
    if (parameters[i].name == name) return effect.parameters.at(i);
  throw std::logic_error(effect.name + " has no parameter " + name);
}

std::optional<std::array<std::string, 2>> sides_of(const PhysicalScene& scene, const std::string& contact) {
  for (std::size_t cut = contact.find('/'); cut != std::string::npos; cut = contact.find('/', cut + 1)) {
    std::array<std::string, 2> sides = {contact.substr(0, cut), contact.substr(cut + 1)};
    if (is_body(scene, sides[0]) && is_body(scene, sides[1])) return sides;
  }
  return std::nullopt;
}

void check_effects(const PhysicalScene& scene) {
  for (const Effect& effect : scene.effects) {
    const EffectKind& kind = effect_kind(effect.name);
    if (const std::string what = lacking(scene, kind, effect.target); !what.empty())
      throw UsageError("effect " + effect.name + ": its target must be " + what + " of the scene, but is `" +
                       effect.target + "`");
    if (is_regressed(kind) || !effect.formulas.empty()) {
      law_of(effect);
      continue;
    }
    if (effect.parameters.size() != kind.parameters.size())
      throw UsageError("effect " + effect.name + " needs " + std::to_string(kind.parameters.size()) + " parameters");
    for (std::size_t i = 0; i < kind.parameters.size(); ++i) {
      const EffectParameter& p = kind.parameters[i];
      if (!(effect.parameters[i] >= p.low && effect.parameters[i] <= p.high))
        throw UsageError("effect " + effect.name + " on " + effect.target + ": " + p.name + " must be in [" +
                         std::to_string(p.low) + ", " + std::to_string(p.high) + "] " + p.unit);
    }
  }
}

}  // namespace pvg
