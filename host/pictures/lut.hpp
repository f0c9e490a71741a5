// A lookup table per colour channel that carries rendered linear values to those that a real camera recorded: fitted to
// pictures of the same view, 256 bins per channel, never falling (weighted pool-adjacent-violators). Pure.
#pragma once
#include <array>
#include <span>
#include <vector>

namespace pvg {

constexpr int LUT_SIZE = 256;

struct Lut {
  std::array<std::array<float, 3>, LUT_SIZE> value;  // of the inputs i / 255, in [0, 1]
};

// Linear between the entries; what is below 0 or above 1 takes the end's.
void apply_lut(const Lut& lut, std::span<float> rgb);

// The non-decreasing sequence closest to `values` in the weighted mean square (Ayer et al. 1955); weights positive.
std::vector<double> pool_adjacent_violators(std::span<const double> values, std::span<const double> weights);

// The same view rendered and recorded, both linear  [height x width x 3].
struct PicturePair {
  int width = 0, height = 0;
  std::vector<float> rendered, real;
};

// Pixels to learn from: none of the two is at either end of its range, and neither has an edge within a pixel, where a
// small misalignment would compare two different things.  [height x width]
std::vector<bool> valid_pixels(const PicturePair& pair);

// Fitted to the pixels that `uses` marks; `uses` [n_pairs][height x width]. Pixels far off the fit, such as things that
// are in one of the pictures only, are left out by their residual (4 robust standard deviations) and the fit is
// repeated. Between the bins that were seen it is linear, beyond them proportional. Throws a UsageError where a channel
// has fewer than 100 pixels.
Lut fit_lut(std::span<const PicturePair> pairs, std::span<const std::vector<bool>> uses);

}  // namespace pvg
