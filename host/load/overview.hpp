// What a scene lacks to be looked at: scenes made for physics alone name no visuals, cameras or lights.
#pragma once
#include <string>
#include <vector>

#include "host/model/scene.hpp"

namespace pvg {

// Adds, where a scene has none at all: a visual of every body's collision surface, a camera `overview` that sees all of
// them at the start, a lamp above and an even sky. Returns one sentence for each thing added.
std::vector<std::string> complete_for_viewing(Scene& scene);

}  // namespace pvg
