// For the record: the element pairs that the contact solver leaves out, in terms of the bodies' own meshes.
#pragma once
#include <vector>

#include "host/dataset/states_file.hpp"

namespace pvg {

// They follow from the scene alone, as the simulation makes them.
std::vector<DisabledPair> disabled_pairs(const PhysicalScene& scene);

}  // namespace pvg
