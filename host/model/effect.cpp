#include "host/model/effect.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "host/base/counted.hpp"
#include "host/base/error.hpp"
#include "host/model/physical_scene.hpp"

namespace pvg {
namespace {

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

const EffectKind& effect_kind(const std::string& name) {
  std::string known;
  for (const EffectKind& kind : effect_kinds()) {
    if (kind.name == name) return kind;
    known += (known.empty() ? "" : ", ") + kind.name;
  }
  throw UsageError("there is no effect `" + name + "`; there are: " + known);
}

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
    throw UsageError(who + " needs " + counted(n_formulas(kind), "formula") + ", but has " +
                     std::to_string(effect.formulas.size()));
  if (effect.parameters.size() > MOST_COEFFICIENTS)
    throw UsageError(who + " may have " + counted(MOST_COEFFICIENTS, "coefficient") + ", but has " +
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
      throw UsageError(formula + "uses c" + std::to_string(law.back().n_coefficients - 1) + ", but the effect has " +
                       counted(effect.parameters.size(), "coefficient"));
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
      throw UsageError("effect " + effect.name + " needs " + counted(kind.parameters.size(), "parameter"));
    for (std::size_t i = 0; i < kind.parameters.size(); ++i) {
      const EffectParameter& p = kind.parameters[i];
      if (!(effect.parameters[i] >= p.low && effect.parameters[i] <= p.high))
        throw UsageError("effect " + effect.name + " on " + effect.target + ": " + p.name + " must be in [" +
                         std::to_string(p.low) + ", " + std::to_string(p.high) + "] " + p.unit);
    }
  }
}

}  // namespace pvg
