// The sections `success`, `failure` and `vary` of a task file.
#include "host/load/read_sections.hpp"

namespace pvg {
namespace {

using Section = YamlSection;
using Quantity = Condition::Quantity;

Unit unit_in_file(Quantity quantity) {
  switch (quantity) {
    case Quantity::tilt:
    case Quantity::joint_angle:
      return Unit::angle;
    case Quantity::held:
      return Unit::none;
    default:
      return Unit::length;
  }
}

Vec3 read_point(Section& section, const std::string& key) { return section.vector(key, Unit::length, -REACH, REACH); }

}  // namespace

const std::vector<std::string>& quantity_names() {
  static const std::vector<std::string> names = {"lifted",        "position_error", "tilt",        "moved_in_hand",
                                                 "slip_in_hand",  "held",           "joint_angle", "corner_distance",
                                                 "edge_distance", "height"};
  return names;
}

const char* unit_of(Quantity quantity) {
  const Unit unit = unit_in_file(quantity);
  return unit == Unit::angle ? "rad" : unit == Unit::length ? "m" : "";
}

Condition read_condition(Section& section, const std::vector<std::string>& robots, Condition::When otherwise) {
  Condition condition;
  condition.quantity = Quantity(section.choice("quantity", quantity_names()));
  condition.of = section.text("of");
  condition.when = Condition::When(section.choice("when", {"end", "some_time", "always"}, std::size_t(otherwise)));
  if (condition.quantity == Quantity::position_error) {
    condition.target = section.text("target", "");
    condition.target_position = read_point(section, "target_position");
    condition.point = section.vector("point", Unit::length, -REACH, REACH, Vec3::Zero());
  }
  if (condition.quantity == Quantity::corner_distance || condition.quantity == Quantity::edge_distance) {
    condition.first = read_point(section, "first");
    condition.second = read_point(section, "second");
  }
  if (condition.quantity == Quantity::edge_distance) {
    condition.first_end = read_point(section, "first_end");
    condition.second_end = read_point(section, "second_end");
  }
  if (condition.quantity == Quantity::moved_in_hand && section.has("robot"))
    condition.robot = int(section.choice("robot", robots));
  const Unit unit = unit_in_file(condition.quantity);
  if (section.has("at_least")) condition.at_least = section.number("at_least", unit, -1e3, 1e3);
  if (section.has("at_most")) condition.at_most = section.number("at_most", unit, -1e3, 1e3);
  if (!condition.at_least && !condition.at_most) section.fail("", "lacks a bound: give `at_least`, `at_most` or both");
  section.done();
  return condition;
}

Variation read_variation(Section& section) {
  using Varied = Variation::Quantity;
  Variation variation;
  variation.quantity = Varied(section.choice("quantity", {"size", "mass", "friction", "stiffness", "color", "light",
                                                          "exposure", "camera_position", "camera_rotation"}));
  variation.of = section.text("of");
  if (variation.quantity == Varied::camera_position)
    variation.range = section.range("by", Unit::length, -1, 1, 0);
  else if (variation.quantity == Varied::camera_rotation)
    variation.range = section.range("by", Unit::angle, -1, 1, 0);
  else
    variation.range = section.range("factor", Unit::none, 1e-3, 1e3, 1);
  section.done();
  return variation;
}

}  // namespace pvg
