#include "host/pictures/lut.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "host/base/error.hpp"
#include "host/base/statistics.hpp"
#include "host/pictures/srgb.hpp"

namespace pvg {
namespace {

constexpr float EDGE = 0.08f;  // largest range of a pixel's neighbourhood, sRGB
constexpr int REFITS = 4;      // without the pixels that were far off
constexpr std::size_t FEWEST_PIXELS = 100;

struct Bin {
  double n = 0, x = 0, y = 0;  // pixels, sums of inputs and outputs
};
using Curve = std::array<float, LUT_SIZE>;

// through the means of the bins that were seen
Curve curve_through(const std::vector<Bin>& bins) {
  std::vector<double> x, y, n;
  for (const Bin& bin : bins) {
    if (bin.n == 0) continue;
    x.push_back(bin.x / bin.n);
    y.push_back(bin.y / bin.n);
    n.push_back(bin.n);
  }
  y = pool_adjacent_violators(y, n);
  Curve curve{};
  for (int i = 0; i < LUT_SIZE; ++i) {
    const double at = i / double(LUT_SIZE - 1);
    const std::size_t k = std::size_t(std::upper_bound(x.begin(), x.end(), at) - x.begin());
    double value;
    if (k == 0)
      value = x[0] > 0 ? y[0] * at / x[0] : y[0];
    else if (k == x.size())
      value = x.back() > 0 ? std::max(y.back(), y.back() * at / x.back()) : y.back();
    else
      value = y[k - 1] + (y[k] - y[k - 1]) * (at - x[k - 1]) / (x[k] - x[k - 1]);
    curve[std::size_t(i)] = float(std::clamp(value, 0.0, 1.0));
  }
  return curve;
}

float look_up(const Curve& curve, float x) {
  const float at = std::clamp(x, 0.0f, 1.0f) * (LUT_SIZE - 1);
  const int i = std::min(int(at), LUT_SIZE - 2);
  return curve[std::size_t(i)] + (at - float(i)) * (curve[std::size_t(i) + 1] - curve[std::size_t(i)]);
}

struct Pixels {
  std::vector<float> x, y;  // of one channel
};

Curve fit_channel(const Pixels& pixels) {
  std::vector<bool> is_used(pixels.x.size(), true);
  Curve curve{};
  for (int round = 0; round <= REFITS; ++round) {
    std::vector<Bin> bins(LUT_SIZE);
    for (std::size_t i = 0; i < pixels.x.size(); ++i) {
      if (!is_used[i]) continue;
      Bin& bin = bins[std::size_t(std::lround(pixels.x[i] * (LUT_SIZE - 1)))];
      ++bin.n;
      bin.x += pixels.x[i];
      bin.y += pixels.y[i];
    }
    curve = curve_through(bins);
    if (round == REFITS) break;
    std::vector<float> residual(pixels.x.size());
    for (std::size_t i = 0; i < residual.size(); ++i) residual[i] = std::abs(pixels.y[i] - look_up(curve, pixels.x[i]));
    // four standard deviations; never below a bin
    const float limit = 4 * std::max(float(SIGMA_OVER_MEDIAN) * upper_median(residual), 0.5f / (LUT_SIZE - 1));
    for (std::size_t i = 0; i < residual.size(); ++i) is_used[i] = residual[i] <= limit;
  }
  return curve;
}

bool is_within(float linear) {
  const float c = linear_to_srgb(std::clamp(linear, 0.0f, 1.0f));
  return c > 1.5f / 255 && c < 253.5f / 255;
}

}  // namespace

void apply_lut(const Lut& lut, std::span<float> rgb) {
  for (std::size_t i = 0; i < rgb.size(); ++i) {
    // not-a-number takes the first entry
    const float at = rgb[i] > 0 ? std::min(rgb[i], 1.0f) * (LUT_SIZE - 1) : 0.0f;
    const std::size_t k = std::min<std::size_t>(std::size_t(at), LUT_SIZE - 2), c = i % 3;
    rgb[i] = lut.value[k][c] + (at - float(k)) * (lut.value[k + 1][c] - lut.value[k][c]);
  }
}

std::vector<double> pool_adjacent_violators(std::span<const double> values, std::span<const double> weights) {
  struct Block {
    double mean, weight;
    std::size_t n;
  };
  std::vector<Block> blocks;
  for (std::size_t i = 0; i < values.size(); ++i) {
    blocks.push_back({values[i], weights[i], 1});
    while (blocks.size() > 1 && blocks.end()[-2].mean > blocks.back().mean) {
      const Block last = blocks.back();
      blocks.pop_back();
      Block& into = blocks.back();
      into.mean = (into.mean * into.weight + last.mean * last.weight) / (into.weight + last.weight);
      into.weight += last.weight;
      into.n += last.n;
    }
  }
  std::vector<double> result;
  for (const Block& block : blocks) result.insert(result.end(), block.n, block.mean);
  return result;
}

std::vector<bool> valid_pixels(const PicturePair& pair) {
  const int w = pair.width, h = pair.height;
  std::vector<bool> is_valid(std::size_t(w) * std::size_t(h), true);
  for (const std::vector<float>* picture : {&pair.rendered, &pair.real}) {
    std::vector<float> coded(picture->size());
    std::transform(picture->begin(), picture->end(), coded.begin(),
                   [](float c) { return linear_to_srgb(std::clamp(c, 0.0f, 1.0f)); });
    for (int y = 0; y < h; ++y)
      for (int x = 0; x < w; ++x) {
        const std::size_t at = std::size_t(y) * std::size_t(w) + std::size_t(x);
        for (std::size_t c = 0; c < 3 && is_valid[at]; ++c) {
          float low = 1, high = 0;
          for (int j = std::max(0, y - 1); j <= std::min(h - 1, y + 1); ++j)
            for (int i = std::max(0, x - 1); i <= std::min(w - 1, x + 1); ++i) {
              const float v = coded[3 * (std::size_t(j) * std::size_t(w) + std::size_t(i)) + c];
              low = std::min(low, v);
              high = std::max(high, v);
            }
          is_valid[at] = is_within((*picture)[3 * at + c]) && high - low <= EDGE;
        }
      }
  }
  return is_valid;
}

Lut fit_lut(std::span<const PicturePair> pairs, std::span<const std::vector<bool>> uses) {
  Lut lut;
  for (std::size_t c = 0; c < 3; ++c) {
    Pixels pixels;
    for (std::size_t p = 0; p < pairs.size(); ++p)
      for (std::size_t i = 0; i < uses[p].size(); ++i) {
        if (!uses[p][i]) continue;
        pixels.x.push_back(std::clamp(pairs[p].rendered[3 * i + c], 0.0f, 1.0f));
        pixels.y.push_back(std::clamp(pairs[p].real[3 * i + c], 0.0f, 1.0f));
      }
    if (pixels.x.size() < FEWEST_PIXELS)
      throw UsageError("only " + std::to_string(pixels.x.size()) +
                       " pixels can be compared; the pictures must show the same view, with smooth areas that are "
                       "neither black nor white");
    const Curve curve = fit_channel(pixels);
    for (std::size_t i = 0; i < LUT_SIZE; ++i) lut.value[i][c] = curve[i];
  }
  return lut;
}

}  // namespace pvg
