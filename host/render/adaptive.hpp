// Paths where the noise is: how many each pixel gets.
//   error of a picture  E = sum over pixels of v / n,  v: relative variance of one path, n: paths of the pixel
//   v = (mean of L^2 - (mean of L)^2) n / (n - 1) / (L^2 + 0.01),  L: luminance that the picture shows, of white 1
//   Of all counts with the same sum the least E has n in proportion to the root of v (Lagrange's multiplier).
// v of a few paths is noisy itself, and a pixel whose first paths found nothing bright would never get more: v and L^2
// are means over a square of pixels, so that what one pixel found its neighbours use too. A count that depends on what
// was found biases the mean: it is too dark where rare paths are bright, too bright where most have no noise and rare
// ones are dark. Measured in docs/measured/2026-11-27_adaptive_sampling.md.
#pragma once
#include <cstdint>
#include <vector>

#include "render/path.h"

namespace pvg {

// [height x width] v of each pixel; film: sums of radiance, last: paths in it;  squares: sums of squared luminance;
// exposure: shown luminance of radiance 1. Zero where a pixel has fewer than two paths.
std::vector<float> path_variances(const std::vector<F32x4>& film, const std::vector<float>& squares, std::size_t width,
                                  float exposure);

// Counts are doubled zero, one or more times, so that samples stay stratified: as often as the best count allows, the
// sum at most `total`. counts: so far, above zero; the sum of them at most `total`.
std::vector<std::uint32_t> doubled_counts(const std::vector<float>& variances, const std::vector<std::uint32_t>& counts,
                                          std::uint64_t total);

}  // namespace pvg
