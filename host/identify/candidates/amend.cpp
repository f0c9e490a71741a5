#include <yaml-cpp/yaml.h>

#include "host/identify/candidates/candidate.hpp"
#include "host/model/effect.hpp"

namespace pvg::diagnose {

void write_effect(YAML::Node& root, const Effect& effect) {
  YAML::Node node;
  node["effect"] = effect.name;
  node["target"] = effect.target;
  const EffectKind& kind = effect_kind(effect.name);
  if (is_regressed(kind)) {
    if (effect.formulas.size() == 1) node["formula"] = effect.formulas[0];
    if (effect.formulas.size() > 1) node["formula"] = effect.formulas;
    node["coefficients"] = effect.parameters;
  } else {
    for (std::size_t i = 0; i < effect.parameters.size(); ++i) node[kind.parameters[i].name] = effect.parameters[i];
  }
  root["effects"].push_back(node);
}

bool amend_last_effect(const SceneFile& file, std::span<const double>) {
  write_effect(file.root, file.amended.effects.back());
  return true;
}

}  // namespace pvg::diagnose
