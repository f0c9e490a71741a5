// Notes on numbers without a unit that are legal in SI, but look as if another unit was meant.
#pragma once
#include <string>

#include "host/load/fields/yaml_section.hpp"

namespace pvg {

void tell_of_light_density(const YamlSection& section, const std::string& key);  // of a solid, perhaps in g/cm^3
void tell_of_many_turns(const YamlSection& section, const std::string& key);     // of a joint, perhaps in degrees

}  // namespace pvg
