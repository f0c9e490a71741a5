// What a mask, the pixels of one part of a picture, says in numbers.
#pragma once
#include <array>
#include <cstdint>
#include <span>

namespace pvg {

// Moments of a mask over the picture, in coordinates x to the right and y down from its middle, +-1 at its edges:
//   M_pq = mean over all pixels of mask x^p y^q,   (p, q) = (0, 0), (1, 0), (0, 1), (2, 0), (1, 1), (0, 2)
// Area, place and shape; 0 where the part is not seen. Smooth while the part moves by parts of a pixel.
inline constexpr std::size_t N_MASK_MOMENTS = 6;
inline constexpr std::array<const char*, N_MASK_MOMENTS> MASK_MOMENT_NAMES = {"area", "x", "y", "xx", "xy", "yy"};

// mask: not 0 where the part is  [height x width]
std::array<double, N_MASK_MOMENTS> mask_moments(std::span<const std::uint8_t> mask, int width, int height);

// Intersection over union of two masks of one size; 1 where both are empty.
double mask_overlap(std::span<const std::uint8_t> a, std::span<const std::uint8_t> b);

}  // namespace pvg
