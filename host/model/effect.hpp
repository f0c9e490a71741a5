// Named physical effects that a model may lack. One list says what there is: each with the name that a physicist uses,
// where it acts (site), its law, its parameters and the experiment that would show it. A scene switches effects on by
// name (`effects:`); the simulator adds them to its incremental potential (host/physics/energies/effects.hpp).
#pragma once
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "host/model/formula.hpp"

namespace pvg {

// What an effect acts on: a joint; a rigid body; a solid (soft body); a solid or cloth; any body; two bodies that
// touch, as "first/second"; or the scene as a whole, whose target is then "scene".
enum class EffectTarget { joint, driven_joint, rigid_body, solid, deformable, body, contact, scene };

struct EffectParameter {
  std::string name, unit;  // of joints: N m of revolute, N of prismatic ones, and so on
  double low = 0, high = 0;
  double off = 0;           // where the effect vanishes, if the strengths (see is_strength) are all there
  bool is_strength = true;  // the effect vanishes with these; the others only shape it
  double usual = 0;         // of those that shape it: taken where the scene does not say
};

struct EffectKind {
  std::string name;
  EffectTarget target;
  std::string site, law;  // such as "joint rate", "smoothed Coulomb"
  std::string meaning;    // one line
  std::string equation;
  std::string experiment;  // what would show it
  std::vector<EffectParameter> parameters;
};

// An effect switched on.
struct Effect {
  std::string name, target;
  std::vector<double> parameters;          // in the order of its kind, SI; the coefficients c0, c1, ... of a law
  std::vector<std::string> formulas = {};  // of a regressed law; empty for all others
};

const std::vector<EffectKind>& effect_kinds();

// Throws a UsageError that lists the names there are.
const EffectKind& effect_kind(const std::string& name);

// Is its law given by formulas, such as a regression finds? Its parameters are then coefficients, as many as it likes.
bool is_regressed(const EffectKind& kind);

// What the formulas of such a kind may name beside coefficients, and how many there are of them.
std::vector<std::string> law_variables(const EffectKind& kind);
std::size_t n_formulas(const EffectKind& kind);

// The formulas of an effect of such a kind, checked. Throws a UsageError that names effect, target, formula and place.
std::vector<Formula> law_of(const Effect& effect);

// Value of the parameter `name` of an effect. Throws std::logic_error where its kind has none such.
double parameter_of(const Effect& effect, const std::string& name);

struct PhysicalScene;
// The two bodies of the scene that `contact`, "first/second", names; names may hold slashes. Nothing where it does not.
std::optional<std::array<std::string, 2>> sides_of(const PhysicalScene& scene, const std::string& contact);

// Throws a UsageError where an effect names what the scene does not have, or a parameter is outside its bounds.
void check_effects(const PhysicalScene& scene);

}  // namespace pvg
