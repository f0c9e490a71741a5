#include "host/render/adaptive.hpp"

#include <algorithm>
#include <cmath>

namespace pvg {
namespace {

constexpr std::size_t REACH = 2;         // of the squares of pixels, 5 x 5
constexpr float DARK = 0.01f;            // added to L^2: noise below a tenth of white is not seen
constexpr std::uint32_t MOST = 1 << 16;  // paths of a pixel

// means over 2 REACH + 1 values around each of a row or column; those beyond its ends are left out
void blur(std::vector<float>& values, std::size_t first, std::size_t n, std::size_t stride) {
  std::vector<double> sums(n + 1, 0.0);
  for (std::size_t i = 0; i < n; ++i) sums[i + 1] = sums[i] + values[first + i * stride];
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t from = i > REACH ? i - REACH : 0, to = std::min(n, i + REACH + 1);
    values[first + i * stride] = float((sums[to] - sums[from]) / double(to - from));
  }
}

void blur(std::vector<float>& values, std::size_t width) {
  const std::size_t height = values.size() / width;
  for (std::size_t y = 0; y < height; ++y) blur(values, y * width, width, 1);
  for (std::size_t x = 0; x < width; ++x) blur(values, x, height, width);
}

// the count times a power of two that is at most `best`
std::uint32_t doubled(std::uint32_t count, double best) {
  while (2.0 * count <= best && count <= MOST / 2) count *= 2;
  return count;
}

}  // namespace

std::vector<float> path_variances(const std::vector<F32x4>& film, const std::vector<float>& squares, std::size_t width,
                                  float exposure) {
  std::vector<float> variances(film.size(), 0.0f), brightness(film.size(), 0.0f);
  for (std::size_t i = 0; i < film.size(); ++i) {
    const float n = film[i].v[3];
    if (n < 2) continue;
    const float mean = (0.2126f * film[i].v[0] + 0.7152f * film[i].v[1] + 0.0722f * film[i].v[2]) / n;
    variances[i] = std::max(0.0f, squares[i] / n - mean * mean) * n / (n - 1);
    brightness[i] = mean * mean;
  }
  blur(variances, width);
  blur(brightness, width);
  const float dark = DARK / (exposure * exposure);
  for (std::size_t i = 0; i < film.size(); ++i) variances[i] /= brightness[i] + dark;
  return variances;
}

std::vector<std::uint32_t> doubled_counts(const std::vector<float>& variances, const std::vector<std::uint32_t>& counts,
                                          std::uint64_t total) {
  std::vector<double> roots;
  roots.reserve(variances.size());
  for (const float variance : variances) roots.push_back(std::sqrt(double(variance)));
  const auto sum_for = [&](double paths_per_root) {
    std::uint64_t sum = 0;
    for (std::size_t i = 0; i < counts.size(); ++i) sum += doubled(counts[i], paths_per_root * roots[i]);
    return sum;
  };
  // the largest factor whose counts are few enough, to a hundredth
  double low = 1e-6, high = 1e12;
  while (high > 1.01 * low) {
    const double middle = std::sqrt(low * high);
    (sum_for(middle) <= total ? low : high) = middle;
  }
  std::vector<std::uint32_t> result(counts.size());
  for (std::size_t i = 0; i < counts.size(); ++i) result[i] = doubled(counts[i], low * roots[i]);
  return result;
}

}  // namespace pvg
