#include "pipeline/episode/receiver_look.hpp"

#include "host/base/error.hpp"

namespace pvg {
namespace {

ReceiverLook receiver_look(const std::string& word) {
  if (word == "kept") return ReceiverLook::kept;
  if (word == "relit") return ReceiverLook::relit;
  if (word == "emissive") return ReceiverLook::emissive;
  throw UsageError("--receivers " + word + " is none of kept, relit, emissive");
}

}  // namespace

void show_receivers(Scene& scene, const std::string& word) {
  const ReceiverLook look = receiver_look(word);
  if (look == ReceiverLook::kept) return;
  bool is_there = false;
  for (VisualMaterial& material : scene.materials) {
    if (material.kind != VisualMaterial::Kind::shadow_receiver) continue;
    is_there = true;
    if (look == ReceiverLook::relit) material.kind = VisualMaterial::Kind::diffuse;
    if (look == ReceiverLook::emissive) material.shadow_strength = 0;
  }
  if (!is_there) throw UsageError("--receivers " + word + ": the scene has no shadow receiver; leave the option out");
}

}  // namespace pvg
