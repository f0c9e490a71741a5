// Numbers that the scene has and that may be wrong: "retune". A number of zero is not there: what it would stand for is
// then an effect.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "host/identify/candidates/candidate.hpp"

namespace pvg::diagnose {
namespace {

constexpr double GRAVITY_BELIEVED = 0.2;  // [m/s^2]
// of the scene's: shape and mass mostly tell it; and it is wrong alone less often than other numbers are, as a log
constexpr double INERTIA_BELIEVED = 0.1, INERTIA_PRIOR = -1;

struct Place {
  std::string target;
  double value = 0;
  std::function<void(Scene&, double)> set;
};

struct Kind {
  const char *name, *unit, *meaning;
  double low, high;  // of the ratio to the scene's value
  std::vector<Place> (*places)(const Scene&, const std::vector<std::string>& touching);
};

bool may_move(const RigidBody& body) { return !body.is_fixed && !body.is_prescribed && !body.is_half_space; }

void scale_mass(RigidBody& body, double mass) {
  body.inertia *= mass / body.mass;
  body.mass = mass;
}

std::vector<Place> masses(const Scene& scene, const std::vector<std::string>&) {
  std::vector<Place> places;
  for (std::size_t b = 0; b < scene.rigid_bodies.size(); ++b)
    if (may_move(scene.rigid_bodies[b]))
      places.push_back({scene.rigid_bodies[b].name, scene.rigid_bodies[b].mass,
                        [b](Scene& s, double value) { scale_mass(s.rigid_bodies[b], value); }});
  return places;
}

// the mean of the three moments stands for all, which keep their ratios
std::vector<Place> inertias(const Scene& scene, const std::vector<std::string>&) {
  std::vector<Place> places;
  for (std::size_t b = 0; b < scene.rigid_bodies.size(); ++b)
    if (may_move(scene.rigid_bodies[b]))
      places.push_back(
          {scene.rigid_bodies[b].name, scene.rigid_bodies[b].inertia.trace() / 3, [b](Scene& s, double value) {
             Mat3& inertia = s.rigid_bodies[b].inertia;
             inertia *= value / (inertia.trace() / 3);
           }});
  return places;
}

std::vector<Place> gravities(const Scene& scene, const std::vector<std::string>&) {
  if (scene.gravity.norm() == 0) return {};
  return {{"scene", scene.gravity.norm(), [](Scene& s, double value) { s.gravity *= value / s.gravity.norm(); }}};
}

// of a soft body's material
template <double SolidMaterial::*member>
std::vector<Place> solid_numbers(const Scene& scene, const std::vector<std::string>&) {
  std::vector<Place> places;
  for (std::size_t b = 0; b < scene.soft_bodies.size(); ++b)
    places.push_back({scene.soft_bodies[b].name, scene.soft_bodies[b].material.*member,
                      [b](Scene& s, double value) { s.soft_bodies[b].material.*member = value; }});
  return places;
}

template <double ClothMaterial::*first, double ClothMaterial::*second>
std::vector<Place> cloth_numbers(const Scene& scene, const std::vector<std::string>&) {
  std::vector<Place> places;
  for (std::size_t b = 0; b < scene.cloths.size(); ++b)
    places.push_back({scene.cloths[b].name, scene.cloths[b].material.*first, [b](Scene& s, double value) {
                        ClothMaterial& m = s.cloths[b].material;
                        const double ratio = value / (m.*first);
                        m.*first *= ratio;
                        if (first != second) m.*second *= ratio;
                      }});
  return places;
}

std::vector<Place> joint_dampings(const Scene& scene, const std::vector<std::string>&) {
  std::vector<Place> places;
  for (std::size_t j = 0; j < scene.joints.size(); ++j)
    places.push_back(
        {scene.joints[j].name, scene.joints[j].damping, [j](Scene& s, double value) { s.joints[j].damping = value; }});
  return places;
}

template <double Drive::*member>
std::vector<Place> drive_numbers(const Scene& scene, const std::vector<std::string>&) {
  std::vector<Place> places;
  for (std::size_t j = 0; j < scene.joints.size(); ++j)
    if (is_driven(scene.joints[j]))
      places.push_back({scene.joints[j].name, scene.joints[j].drive.*member,
                        [j](Scene& s, double value) { s.joints[j].drive.*member = value; }});
  return places;
}

double friction_of(const Scene& scene, const std::string& body) {
  for (const RigidBody& b : scene.rigid_bodies)
    if (b.name == body) return b.friction;
  for (const SoftBody& b : scene.soft_bodies)
    if (b.name == body) return b.friction;
  for (const Cloth& b : scene.cloths)
    if (b.name == body) return b.friction;
  return 0;
}

std::vector<Place> frictions(const Scene& scene, const std::vector<std::string>& touching) {
  std::vector<Place> places;
  for (const std::string& pair : touching) {
    const std::size_t cut = pair.find('/');
    const std::string first = pair.substr(0, cut), second = pair.substr(cut + 1);
    double value = std::sqrt(friction_of(scene, first) * friction_of(scene, second));
    for (const PairFriction& given : scene.pair_friction)
      if ((given.first == first && given.second == second) || (given.first == second && given.second == first))
        value = given.coefficient;
    places.push_back({pair, value, [first, second](Scene& s, double coefficient) {
                        std::erase_if(s.pair_friction, [&](const PairFriction& p) {
                          return (p.first == first && p.second == second) || (p.first == second && p.second == first);
                        });
                        s.pair_friction.push_back({first, second, coefficient});
                      }});
  }
  return places;
}

std::vector<Place> contact_stiffnesses(const Scene& scene, const std::vector<std::string>& touching) {
  if (touching.empty()) return {};
  return {{"scene", scene.contact.stiffness, [](Scene& s, double value) { s.contact.stiffness = value; }}};
}

const std::vector<Kind>& kinds() {
  static const std::vector<Kind> KINDS = {
      {"retune_mass", "kg", "the body's mass is not what the scene says, its inertia with it", 0.2, 5, masses},
      {"retune_inertia", "kg m^2", "the body's mean moment of inertia is not what the scene says, its mass is", 0.3, 3,
       inertias},
      {"retune_gravity", "m/s^2", "gravity is not as strong as the scene says", 0.9, 1.1, gravities},
      {"retune_youngs_modulus", "Pa", "the material is softer or stiffer than the scene says", 0.05, 20,
       solid_numbers<&SolidMaterial::youngs_modulus>},
      {"retune_density", "kg/m^3", "the material is lighter or heavier than the scene says", 0.2, 5,
       solid_numbers<&SolidMaterial::density>},
      {"retune_joint_damping", "N m s/rad", "the joint's damping is not what the scene says", 0, 20, joint_dampings},
      {"retune_drive_stiffness", "N m/rad", "the drive's stiffness is not what the scene says", 0.05, 20,
       drive_numbers<&Drive::stiffness>},
      {"retune_drive_damping", "N m s/rad", "the drive's damping is not what the scene says", 0, 20,
       drive_numbers<&Drive::damping>},
      {"retune_effort_limit", "N m", "the drive's effort limit is not what the scene says", 0.05, 20,
       drive_numbers<&Drive::effort_limit>},
      {"retune_friction", "1", "the coefficient of friction is not what the scene says", 0, 5, frictions},
      {"retune_contact_stiffness", "Pa", "contacts are softer or stiffer than the scene says", 0.01, 100,
       contact_stiffnesses},
      {"retune_area_density", "kg/m^2", "the cloth is lighter or heavier than the scene says", 0.2, 5,
       cloth_numbers<&ClothMaterial::area_density, &ClothMaterial::area_density>},
      {"retune_bending_stiffness", "N m", "the cloth bends more or less easily than the scene says", 0.05, 20,
       cloth_numbers<&ClothMaterial::bending_warp, &ClothMaterial::bending_weft>},
      {"retune_stretch_stiffness", "N/m", "the cloth stretches more or less than the scene says", 0.05, 20,
       cloth_numbers<&ClothMaterial::stretch_warp, &ClothMaterial::stretch_weft>},
  };
  return KINDS;
}

std::string as_the_scene_says(double value, const std::string& unit) {
  char text[60];
  std::snprintf(text, sizeof text, "%.4g", value);
  return "the scene says " + (text + (unit == "1" ? "" : " " + unit));
}

}  // namespace

std::vector<CandidateKind> parameter_kinds() {
  std::vector<CandidateKind> list;
  for (const Kind& kind : kinds())
    list.push_back(
        {kind.name, "scene", "another value", kind.meaning, Family::parameter, {{"value", kind.unit, 0, 1e12, 0, 1}}});
  return list;
}

void add_parameters(const Problem& problem, const std::vector<std::string>& touching, std::vector<Candidate>& out) {
  for (const Kind& kind : kinds())
    for (const Place& place : kind.places(problem.scene.scene, touching)) {
      if (!(place.value > 0)) continue;
      const std::string unit = unit_on(problem.scene.scene, place.target, kind.unit);
      Candidate candidate{kind.name,
                          place.target,
                          Family::parameter,
                          "scene",
                          "another value",
                          kind.meaning,
                          as_the_scene_says(place.value, unit),
                          "",
                          {},
                          {},
                          0};
      candidate.parameters = {
          {"value", unit, kind.low * place.value, kind.high * place.value, place.value, 0.1 * place.value}};
      if (kind.places == gravities) candidate.parameters[0].believed = GRAVITY_BELIEVED;
      if (kind.places == inertias) {
        candidate.parameters[0].believed = INERTIA_BELIEVED * place.value;
        candidate.prior = INERTIA_PRIOR;
      }
      candidate.apply = [set = place.set](Variant& variant, std::span<const double> values) {
        set(variant.scene, values[0]);
      };
      candidate.experiment = "a second motion in which this number matters differently";
      out.push_back(std::move(candidate));
    }
}

}  // namespace pvg::diagnose
