#include "host/identify/data/scene_entry.hpp"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <map>

namespace pvg::diagnose {

YAML::Node entry_named(const YAML::Node& list, const std::string& name) {
  for (std::size_t i = 0; list.IsDefined() && list.IsSequence() && i < list.size(); ++i)
    if (list[i]["name"] && list[i]["name"].Scalar() == name) return list[i];
  return YAML::Node(YAML::NodeType::Undefined);
}

std::string unit_on(const PhysicalScene& scene, const std::string& target, const std::string& unit) {
  static const std::map<std::string, std::string> ALONG = {{"N m", "N"}, {"N m s/rad", "N s/m"}, {"N m/rad", "N/m"},
                                                           {"rad", "m"}, {"rad/s", "m/s"},       {"kg m^2", "kg"}};
  const auto joint = std::find_if(scene.joints.begin(), scene.joints.end(),
                                  [&](const Joint& candidate) { return candidate.name == target; });
  const auto along = ALONG.find(unit);
  const bool slides = joint != scene.joints.end() && joint->type == Joint::Type::prismatic;
  return slides && along != ALONG.end() ? along->second : unit;
}

}  // namespace pvg::diagnose
