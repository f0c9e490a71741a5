#include "host/load/fields/doubtful_numbers.hpp"

#include <cmath>
#include <numbers>

#include "host/base/notes.hpp"
#include "host/load/fields/fields.hpp"

namespace pvg {
namespace {

constexpr double LIGHT = 10;                         // foams begin here [kg/m^3]
constexpr double MANY_TURNS = 4 * std::numbers::pi;  // [rad]

}  // namespace

void tell_of_light_density(const YamlSection& section, const std::string& key) {
  for (const double value : section.bare_numbers(key))
    if (value < LIGHT) {
      const std::string n = shown_number(value);
      return tell_note(section.place_of(key) + " is " + n + " kg/m^3, lighter than foam: is it in g/cm^3? Write `" + n +
                       " g/cm^3`, or `" + n + " kg/m^3` where it is meant");
    }
}

void tell_of_many_turns(const YamlSection& section, const std::string& key) {
  for (const double value : section.bare_numbers(key))
    if (std::abs(value) > MANY_TURNS) {
      const std::string n = shown_number(value);
      return tell_note(section.place_of(key) + " holds " + n + " rad, more than two turns: is it in degrees? Write `" +
                       n + " deg`, or `" + n + " rad` where it is meant");
    }
}

}  // namespace pvg
