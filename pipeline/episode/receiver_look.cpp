#include "pipeline/episode/receiver_look.hpp"

#include "host/base/error.hpp"

namespace pvg {

void show_receivers(Scene& scene, const std::string& look) {
  if (look == "kept") return;
  if (look != "relit" && look != "emissive")
    throw UsageError("--receivers " + look + " is none of kept, relit, emissive");
  bool is_there = false;
  for (VisualMaterial& material : scene.materials) {
    if (material.kind != VisualMaterial::Kind::shadow_receiver) continue;
    is_there = true;
    if (look == "relit")
      material.kind = VisualMaterial::Kind::diffuse;
    else
      material.shadow_strength = 0;
  }
  if (!is_there) throw UsageError("--receivers " + look + ": the scene has no shadow receiver; leave the option out");
}

}  // namespace pvg
