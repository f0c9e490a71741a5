// What the row of an effect says: its kind, what it does to the scene or to an element of a term, and how likely it is
// before any data. The rows are in effect_list.hpp.
#pragma once
#include <string>
#include <variant>
#include <vector>

#include "host/model/physical_scene.hpp"

namespace pvg {

// What effects add to elements of terms that exist. Units of joints are those of revolute ones.
struct JointNumbers {
  double damping = 0;                          // [N m s/rad]
  double stiffness = 0, preload = 0;           // [N m/rad], [N m]
  double coulomb = 0, extra = 0;               // [N m]
  double velocity = 1, stribeck_velocity = 1;  // [rad/s]
};

struct DragNumbers {
  Vec3 force = Vec3::Zero();   // [N]
  double linear = 0;           // [N s/m]
  double linear_per_mass = 0;  // of particles [1/s]
  double quadratic = 0;        // [N s^2/m^2]
};

struct StrainNumbers {
  double stiffening = 0;   // over mu
  double viscosity = 0;    // [Pa s]
  double loss = 0;         // hysteresis over 2 mu
  double strain_rate = 1;  // [1/s]
};

// What rubber's density adds to that of an element, Ogden's `ogden` and C20, C30 of Yeoh as shares of mu and C10 =
// mu/2.
struct HyperelasticNumbers {
  double yeoh_2 = 0, yeoh_3 = 0;
  double ogden = 0, exponent = 2;
  double logarithm = 0;  // 1: the neo-Hookean density with the logarithm
};

struct FlowNumbers {
  double rate = 0;          // [1/s]
  double yield_strain = 0;  // 0: none
};

struct ContactNumbers {
  double adhesion = 0;         // [J/m^2]
  double dissipation = 0;      // of the approach [s/m]
  double slip_change = 0;      // of the coefficient of friction, fully developed far above slip_velocity
  double slip_velocity = 0.1;  // [m/s]
  double across_change = 0;    // of the coefficient across the first body's x
};

enum class EffectTerm : int;  // a term that only this effect has (effect_list.hpp)

using EffectAction = std::variant<void (*)(PhysicalScene&, const Effect&), void (*)(JointNumbers&, const Effect&),
                                  void (*)(DragNumbers&, const Effect&), void (*)(StrainNumbers&, const Effect&),
                                  void (*)(HyperelasticNumbers&, const Effect&), void (*)(FlowNumbers&, const Effect&),
                                  void (*)(ContactNumbers&, const Effect&), EffectTerm>;

struct EffectRow {
  EffectKind kind;
  EffectAction action;
  // What a diagnosis holds of it before any data. Left out: possible at every target, a log prior of 0, any size.
  bool (*is_possible)(const PhysicalScene&, const std::string& target) = nullptr;
  double (*log_prior)(const PhysicalScene&, const std::string& target) = nullptr;
  double (*prior_sigma)(const PhysicalScene&, const std::string& unit,
                        double mass) = nullptr;  // of a parameter; 0: any size
  const char* rounding = nullptr;  // a parameter that only rounds off a corner of the law, and is not fitted
  bool acts_on_first = false;      // of a contact: on its first body alone, so both orders are candidates
};

const std::vector<EffectRow>& effect_rows();
const EffectRow& effect_row(const std::string& name);  // throws as effect_kind does

// The numbers that an effect gives to elements of one sort; nothing where it gives none to them.
template <class Numbers>
bool add_numbers(const Effect& effect, Numbers& numbers) {
  const auto* action = std::get_if<void (*)(Numbers&, const Effect&)>(&effect_row(effect.name).action);
  if (action != nullptr) (*action)(numbers, effect);
  return action != nullptr;
}

}  // namespace pvg
