// The sections `success` and `failure` of a task file.
#include "host/load/read_sections.hpp"

namespace pvg {
namespace {

using Section = YamlSection;
Unit unit_in_file(const Condition& condition) {
  switch (kind_of(condition).unit) {
    case QuantityKind::Unit::rad:
      return Unit::angle;
    case QuantityKind::Unit::m:
      return Unit::length;
    default:
      return Unit::none;
  }
}

Vec3 read_point(Section& section, const std::string& key) { return section.vector(key, Unit::length, -REACH, REACH); }

}  // namespace

Condition read_condition(Section& section, const std::vector<std::string>& robots, Condition::When otherwise) {
  Condition condition;
  std::vector<std::string> names;
  for (const QuantityKind& kind : QUANTITY_KINDS) names.push_back(kind.name);
  condition.quantity = Condition::Quantity(section.choice("quantity", names));
  condition.of = section.text("of");
  condition.when = Condition::When(section.choice("when", {"end", "some_time", "always"}, std::size_t(otherwise)));
  const int keys = kind_of(condition).keys;
  if ((keys & TARGET_KEYS) == TARGET_KEYS) {
    condition.target = section.text("target", "");
    condition.target_position = read_point(section, "target_position");
    condition.point = section.vector("point", Unit::length, -REACH, REACH, Vec3::Zero());
  }
  if ((keys & POINT_KEYS) == POINT_KEYS) {
    condition.first = read_point(section, "first");
    condition.second = read_point(section, "second");
  }
  if ((keys & EDGE_KEYS) == EDGE_KEYS) {
    condition.first_end = read_point(section, "first_end");
    condition.second_end = read_point(section, "second_end");
  }
  if ((keys & ROBOT_KEY) == ROBOT_KEY) {
    if (robots.size() > 1 && !section.has("robot"))
      section.fail("", "lacks the key `robot`: the task has several, say whose hand is watched");
    if (section.has("robot")) condition.robot = int(section.choice("robot", robots));
  }
  const Unit unit = unit_in_file(condition);
  if (section.has("at_least")) condition.at_least = section.number("at_least", unit, -1e3, 1e3);
  if (section.has("at_most")) condition.at_most = section.number("at_most", unit, -1e3, 1e3);
  if (!condition.at_least && !condition.at_most) section.fail("", "lacks a bound: give `at_least`, `at_most` or both");
  section.done();
  return condition;
}

}  // namespace pvg
