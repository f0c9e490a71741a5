// The section `effects` of scene and task files: {effect: NAME, target: BODY or JOINT, and its parameters}.
#include <algorithm>

#include "host/scene/read_sections.hpp"

namespace pvg {
namespace {

constexpr Unit UNITS[] = {Unit::length, Unit::mass,  Unit::time,    Unit::force,     Unit::pressure,
                          Unit::speed,  Unit::angle, Unit::damping, Unit::per_length};

// Those of joints stand for two dimensions, others are rare: such numbers are written bare, in SI.
Unit unit_named(const EffectKind& kind, const std::string& name) {
  if (kind.target == EffectTarget::joint || kind.target == EffectTarget::driven_joint)
    return name == "s" ? Unit::time : Unit::none;
  const auto found = std::find_if(std::begin(UNITS), std::end(UNITS), [&](Unit unit) { return si_unit(unit) == name; });
  return found == std::end(UNITS) ? Unit::none : *found;
}

}  // namespace

Effect read_effect(YamlSection& section) {
  Effect effect{section.text("effect"), section.text("target"), {}};
  const EffectKind* kind = find_named(effect_kinds(), effect.name);
  if (!kind)
    section.fail("effect", "is `" + effect.name + "`; `phyvisgen diagnose --list-effects` prints those there are");
  for (const EffectParameter& p : kind->parameters) {
    const Unit unit = unit_named(*kind, p.unit);
    effect.parameters.push_back(p.is_strength ? section.number(p.name, unit, p.low, p.high)
                                              : section.number(p.name, unit, p.low, p.high, p.usual));
  }
  section.done();
  return effect;
}

}  // namespace pvg
