// Figures of a seven-segment display.
#pragma once
#include <string>

#include "host/pictures/picture.hpp"

namespace pvg {

// figures: digits, '-', and '.' behind a digit, set flush right in `n_places` equal places; lit segments are white, all
// else is black. [height x width]
Texture seven_segments(const std::string& figures, int n_places, int width, int height);

}  // namespace pvg
