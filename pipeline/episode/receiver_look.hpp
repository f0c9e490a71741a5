// Shadow receivers shown otherwise: what other renderers make of a captured surface, for comparison.
#pragma once
#include <string>

#include "host/model/scene.hpp"

namespace pvg {

// look, a word:
//   kept      as the scene says
//   relit     a diffuse surface of the captured colours below the scene's lights: the captured light is in it twice
//   emissive  the captured look, without shadows of what stands there
// A UsageError for another word, and where the scene has no shadow receiver.
void show_receivers(Scene& scene, const std::string& look);

}  // namespace pvg
