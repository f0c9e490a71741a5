// What the scene file and the scene call the same thing.
#pragma once
#include <string>

#include "host/model/physical_scene.hpp"

namespace YAML {
class Node;
}

namespace pvg::diagnose {

// The entry of a list with this name; undefined where there is none.
YAML::Node entry_named(const YAML::Node& list, const std::string& name);

// Of a number that acts on `target`, whose kind is listed with the unit that revolute joints have.
std::string unit_on(const PhysicalScene& scene, const std::string& target, const std::string& unit);

}  // namespace pvg::diagnose
