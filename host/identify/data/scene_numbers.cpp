// The numbers of the scene that a diagnosis may correct: one row each, with what it needs beside.
#include <cmath>

#include "host/geometry/mass_properties.hpp"
#include "host/identify/criteria.hpp"
#include "host/identify/data/problem.hpp"
#include "host/identify/data/scene_number.hpp"

namespace pvg::diagnose {
namespace {

using Places = std::vector<NumberPlace>;
using Touching = std::vector<std::string>;

// ---- mass: the inertia keeps its proportion to it

Places masses(const PhysicalScene& scene, const Touching&) {
  Places places;
  for (std::size_t b = 0; b < scene.rigid_bodies.size(); ++b)
    if (can_move(scene.rigid_bodies[b]))
      places.push_back({scene.rigid_bodies[b].name, scene.rigid_bodies[b].mass, [b](PhysicalScene& s, double value) {
                          RigidBody& body = s.rigid_bodies[b];
                          body.inertia *= value / body.mass;
                          body.mass = value;
                        }});
  return places;
}

bool write_mass(const NumberInFile& number) {
  YAML::Node entry = entry_named(number.root["bodies"], number.target);
  if (!entry.IsDefined() || !entry.IsMap()) entry.reset(entry_named(number.root["objects"], number.target));
  if (!entry.IsDefined() || !entry.IsMap()) return false;
  entry.remove("density");
  entry["mass"] = number.value;
  if (!entry["inertia"]) return true;
  for (const RigidBody& body : number.amended.rigid_bodies)
    if (body.name == number.target) entry["inertia"] = moments_and_products(body.inertia);
  return true;
}

// ---- inertia: the mean of the three moments is corrected, and they keep their ratios

Places inertias(const PhysicalScene& scene, const Touching&) {
  Places places;
  for (std::size_t b = 0; b < scene.rigid_bodies.size(); ++b)
    if (can_move(scene.rigid_bodies[b]))
      places.push_back(
          {scene.rigid_bodies[b].name, scene.rigid_bodies[b].inertia.trace() / 3, [b](PhysicalScene& s, double value) {
             Mat3& inertia = s.rigid_bodies[b].inertia;
             inertia *= value / (inertia.trace() / 3);
           }});
  return places;
}

bool write_inertia(const NumberInFile& number) {
  YAML::Node body = entry_named(number.root["bodies"], number.target);
  if (!body.IsDefined() || !body.IsMap()) return false;
  for (const RigidBody& rigid : number.amended.rigid_bodies) {
    if (rigid.name != number.target) continue;
    body["inertia"] = moments_and_products(rigid.inertia);
    return true;
  }
  return false;
}

// ---- gravity: its direction stays

Places gravities(const PhysicalScene& scene, const Touching&) {
  if (scene.gravity.norm() == 0) return {};
  return {
      {"scene", scene.gravity.norm(), [](PhysicalScene& s, double value) { s.gravity *= value / s.gravity.norm(); }}};
}

bool write_gravity(const NumberInFile& number) {
  YAML::Node g = number.root["gravity"];
  if (!g) g = number.root["gravity"] = std::vector<double>{0, 0, -9.81};
  for (std::size_t k = 0; k < 3; ++k) g[k] = g[k].as<double>() * number.ratio;
  return true;
}

// ---- numbers that one key says

template <double SolidMaterial::*member>
double* of_material(SoftBody& body) {
  return &(body.material.*member);
}

double* damping_of(Joint& joint) { return &joint.damping; }
double* armature_of(Joint& joint) { return joint.armature > 0 ? &joint.armature : nullptr; }

template <double Drive::*member>
double* of_drive(Joint& joint) {
  return is_driven(joint) ? &(joint.drive.*member) : nullptr;
}

double* area_density_of(Cloth& cloth) { return &cloth.material.area_density; }

// ---- stiffness of cloth: that of the warp is corrected, and warp and weft keep their ratio

template <double ClothMaterial::*warp, double ClothMaterial::*weft>
Places cloth_stiffnesses(const PhysicalScene& scene, const Touching&) {
  Places places;
  for (std::size_t c = 0; c < scene.cloths.size(); ++c)
    places.push_back({scene.cloths[c].name, scene.cloths[c].material.*warp, [c](PhysicalScene& s, double value) {
                        ClothMaterial& m = s.cloths[c].material;
                        const double ratio = value / (m.*warp);
                        m.*warp *= ratio;
                        m.*weft *= ratio;
                      }});
  return places;
}

// Scales key, key_warp and key_weft, as many as the file says; false where it says none, or one with a unit.
template <Key key>
bool write_cloth_stiffness(const NumberInFile& number) {
  YAML::Node cloth = entry_named(number.root["cloths"], number.target);
  if (!cloth.IsDefined() || !cloth.IsMap() || !cloth["material"]) return false;
  YAML::Node material = cloth["material"];
  std::vector<std::pair<std::string, double>> said;
  for (const char* ending : {"", "_warp", "_weft"}) {
    const std::string name = std::string(key.text) + ending;
    if (!material[name]) continue;
    said.emplace_back(name, 0);
    if (!YAML::convert<double>::decode(material[name], said.back().second)) return false;
  }
  for (const auto& [name, value] : said) material[name] = value * number.ratio;
  return !said.empty();
}

// ---- contact

double friction_of(const PhysicalScene& scene, const std::string& body) {
  for (const RigidBody& b : scene.rigid_bodies)
    if (b.name == body) return b.friction;
  for (const SoftBody& b : scene.soft_bodies)
    if (b.name == body) return b.friction;
  for (const Cloth& b : scene.cloths)
    if (b.name == body) return b.friction;
  return 0;
}

Places frictions(const PhysicalScene& scene, const Touching& touching) {
  Places places;
  for (const std::string& pair : touching) {
    const std::size_t cut = pair.find('/');
    const std::string first = pair.substr(0, cut), second = pair.substr(cut + 1);
    double value = std::sqrt(friction_of(scene, first) * friction_of(scene, second));
    for (const PairFriction& given : scene.pair_friction)
      if ((given.first == first && given.second == second) || (given.first == second && given.second == first))
        value = given.coefficient;
    places.push_back({pair, value, [first, second](PhysicalScene& s, double coefficient) {
                        std::erase_if(s.pair_friction, [&](const PairFriction& p) {
                          return (p.first == first && p.second == second) || (p.first == second && p.second == first);
                        });
                        s.pair_friction.push_back({first, second, coefficient});
                      }});
  }
  return places;
}

bool write_friction(const NumberInFile& number) {
  const std::size_t cut = number.target.find('/');
  const std::string first = number.target.substr(0, cut), second = number.target.substr(cut + 1);
  YAML::Node list(YAML::NodeType::Sequence);
  for (const auto& pair : number.root["pair_friction"]) {
    const std::string a = pair["first"].Scalar(), b = pair["second"].Scalar();
    if ((a != first || b != second) && (a != second || b != first)) list.push_back(pair);
  }
  YAML::Node pair;
  pair["first"] = first;
  pair["second"] = second;
  pair["coefficient"] = number.value;
  list.push_back(pair);
  number.root["pair_friction"] = list;
  return true;
}

// ---- restitution, of the pairs that have a coefficient

Places restitutions(const PhysicalScene& scene, const Touching&) {
  Places places;
  for (std::size_t i = 0; i < scene.pair_restitution.size(); ++i) {
    const PairRestitution& pair = scene.pair_restitution[i];
    places.push_back({pair.first + "/" + pair.second, pair.coefficient, [i](PhysicalScene& s, double value) {
                        s.pair_restitution[i].coefficient = std::min(value, 1.0);
                      }});
  }
  return places;
}

bool write_restitution(const NumberInFile& number) {
  for (auto pair : number.root["pair_restitution"]) {
    if (pair["first"].Scalar() + "/" + pair["second"].Scalar() != number.target) continue;
    pair["coefficient"] = std::min(number.value, 1.0);
    return true;
  }
  return false;
}

Places contact_stiffnesses(const PhysicalScene& scene, const Touching& touching) {
  if (touching.empty()) return {};
  return {{"scene", scene.contact.stiffness, [](PhysicalScene& s, double value) { s.contact.stiffness = value; }}};
}

bool write_contact_stiffness(const NumberInFile& number) {
  number.root["contact"]["stiffness"] = number.value;
  return true;
}

}  // namespace

std::span<const SceneNumber> scene_numbers() {
  static const SceneNumber NUMBERS[] = {
      // a scale tells it, so it is wrong less often than what only motions tell, such as a damping that moves a
      // pendulum alike
      {.name = "retune_mass",
       .unit = "kg",
       .meaning = "the body's mass is not what the scene says, its inertia with it",
       .low = criteria().number_far_below,
       .high = criteria().number_far_above,
       .places = masses,
       .write = write_mass,
       .log_prior = -0.4,
       .is_logarithmic = true},
      // it mostly follows from shape and mass, so it is wrong alone less often than other numbers
      {.name = "retune_inertia",
       .unit = "kg m^2",
       .meaning = "the body's mean moment of inertia is not what the scene says, its mass is",
       .low = criteria().number_far_below,
       .high = criteria().number_far_above,
       .places = inertias,
       .write = write_inertia,
       .prior_sigma_share = 0.1,
       .log_prior = -1,
       .is_logarithmic = true},
      // in a fluid, on a slope or elsewhere it is another one, which is rare
      {.name = "retune_gravity",
       .unit = "m/s^2",
       .meaning = "gravity is not as strong as the scene says",
       .low = criteria().number_far_below,
       .high = criteria().number_far_above,
       .places = gravities,
       .write = write_gravity,
       .prior_sigma = 0.2,
       .is_logarithmic = true},
      {"retune_youngs_modulus", "Pa", "the material is softer or stiffer than the scene says", 0.05, 20,
       in_each<&Scene::soft_bodies, of_material<&SolidMaterial::youngs_modulus>>,
       write_in_section<"bodies", "material", "youngs_modulus">},
      {"retune_density", "kg/m^3", "the material is lighter or heavier than the scene says", 0.2, 5,
       in_each<&Scene::soft_bodies, of_material<&SolidMaterial::density>>,
       write_in_section<"bodies", "material", "density">},
      {"retune_joint_damping", "N m s/rad", "the joint's damping is not what the scene says", 0,
       criteria().number_far_above, in_each<&Scene::joints, damping_of>, write_in_entry<"joints", "damping">},
      {.name = "retune_armature",
       .unit = "kg m^2",
       .meaning = "the inertia of the joint's rotor is not what the scene says",
       .low = criteria().number_far_below,
       .high = criteria().number_far_above,
       .places = in_each<&Scene::joints, armature_of>,
       .write = write_in_entry<"joints", "armature">,
       .is_logarithmic = true,
       .is_often_far = true},
      {.name = "retune_drive_stiffness",
       .unit = "N m/rad",
       .meaning = "the drive's stiffness is not what the scene says",
       .low = criteria().number_far_below,
       .high = criteria().number_far_above,
       .places = in_each<&Scene::joints, of_drive<&Drive::stiffness>>,
       .write = write_in_section<"joints", "drive", "stiffness">,
       .is_logarithmic = true,
       .is_often_far = true},
      {"retune_drive_damping", "N m s/rad", "the drive's damping is not what the scene says", 0,
       criteria().number_far_above, in_each<&Scene::joints, of_drive<&Drive::damping>>,
       write_in_section<"joints", "drive", "damping">},
      {.name = "retune_effort_limit",
       .unit = "N m",
       .meaning = "the drive's effort limit is not what the scene says",
       .low = criteria().number_far_below,
       .high = criteria().number_far_above,
       .places = in_each<&Scene::joints, of_drive<&Drive::effort_limit>>,
       .write = write_in_section<"joints", "drive", "effort_limit">,
       .is_logarithmic = true,
       .is_often_far = true},
      {"retune_friction", "1", "the coefficient of friction is not what the scene says", 0, 5, frictions,
       write_friction},
      {"retune_restitution", "1", "the coefficient of restitution is not what the scene says", 0, 10, restitutions,
       write_restitution},
      {"retune_contact_stiffness", "Pa", "contacts are softer or stiffer than the scene says", 0.01, 100,
       contact_stiffnesses, write_contact_stiffness},
      {"retune_area_density", "kg/m^2", "the cloth is lighter or heavier than the scene says", 0.2, 5,
       in_each<&Scene::cloths, area_density_of>, write_in_section<"cloths", "material", "area_density">},
      {"retune_bending_stiffness", "N m", "the cloth bends more or less easily than the scene says", 0.05, 20,
       cloth_stiffnesses<&ClothMaterial::bending_warp, &ClothMaterial::bending_weft>, write_cloth_stiffness<"bending">},
      {"retune_stretch_stiffness", "N/m", "the cloth stretches more or less than the scene says", 0.05, 20,
       cloth_stiffnesses<&ClothMaterial::stretch_warp, &ClothMaterial::stretch_weft>, write_cloth_stiffness<"stretch">},
  };
  return NUMBERS;
}

}  // namespace pvg::diagnose
