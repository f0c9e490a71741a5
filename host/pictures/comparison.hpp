// Pictures that show where two pictures or two masks differ. Pure.
#pragma once
#include <cstdint>
#include <span>

#include "host/pictures/picture.hpp"

namespace pvg {

// The picture, darkened, with the outlines of both masks: pixels of a mask that have a neighbour outside of it. Green:
// real, magenta: simulated, white: both.  masks: not 0 where the part is  [height x width]
Picture8 outline_overlay(const Picture8& picture, std::span<const std::uint8_t> real,
                         std::span<const std::uint8_t> simulated);

// Mean absolute difference of the channels, in [0, 1], as a colour: black 0, through blue, red and yellow to white from
// `most` on.
Picture8 error_map(const Picture8& a, const Picture8& b, double most = 0.25);

}  // namespace pvg
