// What a diagnosis has read of files that the scene's file only names, as bytes for the journal's key: meshes,
// textures, a map of the surroundings, calibrated cameras, a lookup table.
#pragma once
#include <vector>

#include "host/identify/data/problem.hpp"

namespace pvg::diagnose {

// Which triangles and elements bodies have; where their points are is part of each question.
void put_meshes(std::vector<char>& bytes, const PhysicalScene& scene);

// All of files that pictures show.
void put_look(std::vector<char>& bytes, const Appearance& seen);
void put_lut(std::vector<char>& bytes, const std::optional<Lut>& lut);

}  // namespace pvg::diagnose
