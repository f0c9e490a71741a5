// What a recording states of a run's start.
#include <stdexcept>

#include "host/base/error.hpp"
#include "host/identify/data/resolve.hpp"

namespace pvg::diagnose {
namespace {

using Kind = Unknown::Kind;

double number_in(const std::string& text, Unit unit, const std::string& place) {
  try {
    return parse_quantity(text, unit);
  } catch (const std::invalid_argument& wrong) {
    throw UsageError(place + " " + wrong.what());
  }
}

double sigma_in(const StatedNumber& stated, Unit unit, const std::string& place) {
  if (stated.value.empty()) throw UsageError(place + " needs a `value`");
  if (stated.sigma.empty()) return 0;
  const double sigma = number_in(stated.sigma, unit, place + ": `sigma`");
  if (!(sigma > 0)) throw UsageError(place + ": `sigma` must be above 0; leave it away where the value is exact");
  return sigma;
}

GivenStart of_joint(const PhysicalScene& scene, const std::array<std::string, 3>& parts, const StatedNumber& stated,
                    const std::string& place) {
  const int j = index_named(scene.joints, parts[1]);
  if (j < 0 || !has_coordinate(scene.joints[std::size_t(j)]))
    throw UsageError(place + " names a joint that the scene does not have, or that has no position");
  const bool turns = scene.joints[std::size_t(j)].type == Joint::Type::revolute, is_rate = parts[2] == "velocity";
  if (!is_rate && parts[2] != "position") throw UsageError(place + " must be the position or the velocity of a joint");
  const Unit unit = is_rate ? (turns ? Unit::angular_speed : Unit::speed) : (turns ? Unit::angle : Unit::length);
  const double sigma = sigma_in(stated, unit, place);
  if (stated.value.size() != 1) throw UsageError(place + " must be one number");
  return {{is_rate ? Kind::joint_rate : Kind::joint_position, j, Vec3::UnitX(), sigma},
          number_in(stated.value[0], unit, place)};
}

void add_of_body(const PhysicalScene& scene, const std::array<std::string, 3>& parts, const StatedNumber& stated,
                 const std::string& place, std::vector<GivenStart>& given) {
  const int b = index_named(scene.rigid_bodies, parts[1]);
  if (b < 0 || !can_move(scene.rigid_bodies[std::size_t(b)]))
    throw UsageError(place + " names a body that is no rigid body of the scene that can move");
  const bool is_velocity = parts[2] == "velocity", is_spin = parts[2] == "angular_velocity";
  if (!is_velocity && !is_spin && parts[2] != "position")
    throw UsageError(place + " must be the position, velocity or angular_velocity of a body");
  const Unit unit = is_velocity ? Unit::speed : is_spin ? Unit::angular_speed : Unit::length;
  const double sigma = sigma_in(stated, unit, place);
  if (stated.value.size() != 3) throw UsageError(place + " must be a list of three numbers, x y z");
  const Kind kind = is_velocity ? Kind::velocity : is_spin ? Kind::spin : Kind::position;
  for (int k = 0; k < 3; ++k)
    given.push_back({{kind, b, Vec3::Unit(k), sigma}, number_in(stated.value[std::size_t(k)], unit, place)});
}

}  // namespace

std::vector<GivenStart> given_starts(const PhysicalScene& scene, const StatedNumbers& stated, const std::string& list) {
  std::vector<GivenStart> given;
  for (const auto& [key, number] : stated) {
    const std::string place = list + "." + key;
    const std::array<std::string, 3> parts = parts_of(key, list);
    if (parts[0] == "joint")
      given.push_back(of_joint(scene, parts, number, place));
    else if (parts[0] == "body")
      add_of_body(scene, parts, number, place, given);
    else
      throw UsageError(place + " must begin with joint/ or body/");
  }
  return given;
}

}  // namespace pvg::diagnose
