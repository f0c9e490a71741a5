// The section `effects` of scene and task files: {effect: NAME, target: BODY or JOINT, and its parameters}. A regressed
// law has {formula: TEXT or [TEXT, TEXT, TEXT], coefficients: [c0, c1, ...]} in their place.
#include <algorithm>

#include "host/base/error.hpp"
#include "host/base/names.hpp"
#include "host/load/tables.hpp"

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

void read_law(YamlSection& section, const EffectKind& kind, Effect& effect) {
  effect.formulas = n_formulas(kind) == 1 ? std::vector{section.text("formula")} : section.texts("formula");
  if (section.has("coefficients")) effect.parameters = section.numbers("coefficients", Unit::none, -1e12, 1e12);
  section.done();
  try {
    law_of(effect);
  } catch (const UsageError& error) {
    section.fail("formula", std::string("cannot be used: ") + error.what());
  }
}

void read_parameters(YamlSection& section, Effect& effect) {
  const EffectKind* kind = find_named(effect_kinds(), effect.name);
  if (!kind)
    section.fail("effect", "is `" + effect.name + "`; `phyvisgen diagnose --list-effects` prints those there are");
  if (is_regressed(*kind)) return read_law(section, *kind, effect);
  for (const EffectParameter& p : kind->parameters) {
    const Unit unit = unit_named(*kind, p.unit);
    effect.parameters.push_back(p.is_strength ? section.number(p.name, unit, p.low, p.high)
                                              : section.number(p.name, unit, p.low, p.high, p.usual));
  }
}

void write_parameters(YamlWriter& w, const Effect& effect) {
  if (effect.formulas.size() == 1) w.entry("formula", effect.formulas[0]);
  if (effect.formulas.size() > 1) w.flow("formula", effect.formulas);
  if (!effect.formulas.empty()) return w.flow("coefficients", effect.parameters);
  const std::vector<EffectParameter>& parameters = effect_kind(effect.name).parameters;
  for (std::size_t i = 0; i < parameters.size(); ++i) w.entry(parameters[i].name, effect.parameters[i]);
}

}  // namespace

const Fields<Effect>& effect_fields() {
  static const Fields<Effect> FIELDS =
      Fields<Effect>()
          .text("effect", &Effect::name, "as `phyvisgen diagnose --list-effects` names it")
          .required()
          .text("target", &Effect::target, "joint, body, two bodies as `FIRST/SECOND`, or `scene`")
          .required()
          .custom({}, read_parameters, write_parameters)
          .always_read()
          .custom({"PARAMETER", "its own", "required, or usual", "its own",
                   "each parameter of the effect under its name; of joints bare, in SI"},
                  nullptr, nullptr)
          .custom({"formula", "", "required", "text, or three texts", "of a regressed law"}, nullptr, nullptr)
          .custom({"coefficients", "", "none", "-1e12 to 1e12", "c0, c1, ... of a regressed law"}, nullptr, nullptr);
  return FIELDS;
}

}  // namespace pvg
