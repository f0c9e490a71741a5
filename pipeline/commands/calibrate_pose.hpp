// Tags of known size and place, as a file lists them: for commands that place cameras and rooms.
#pragma once
#include <string>
#include <vector>

#include "host/calibration/calibration.hpp"

namespace pvg {

// tags: a list of {id, size, position, rotation}. UsageErrors name file, line and key.
std::vector<PlacedTag> read_tags(const std::string& file);

}  // namespace pvg
