#include "host/render/adaptive.hpp"

#include <algorithm>
#include <bit>
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

// floor(log2(number)) of a number that is not negative, read from its exponent; far below zero for 0
int whole_doublings(double number) { return int(std::bit_cast<std::uint64_t>(number) >> 52) - 1023; }

// Counts doubled while they do not exceed the best ones, which are a factor times the roots of the variances.
struct Doublings {
  std::vector<double> per_factor;           // best count over the present one, for a factor of 1
  std::vector<std::uint32_t> counts, most;  // present ones, and how often each may be doubled at most

  std::uint32_t count(std::size_t i, double factor) const {
    return counts[i] << std::clamp(whole_doublings(factor * per_factor[i]), 0, int(most[i]));
  }
};

Doublings make_doublings(const std::vector<float>& variances, const std::vector<std::uint32_t>& counts) {
  Doublings made{{}, counts, {}};
  made.per_factor.reserve(counts.size());
  made.most.reserve(counts.size());
  for (std::size_t i = 0; i < counts.size(); ++i) {
    const double root = std::sqrt(double(variances[i]));
    made.per_factor.push_back(root > 0 ? root / counts[i] : 0);  // what is not a number shows no noise
    made.most.push_back(std::uint32_t(std::max(0, whole_doublings(double(MOST) / counts[i]))));
  }
  return made;
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
  const Doublings doublings = make_doublings(variances, counts);
  const auto are_few_enough = [&](double factor) {
    std::uint64_t sum = 0;
    for (std::size_t i = 0; i < counts.size() && sum <= total; ++i) sum += doublings.count(i, factor);
    return sum <= total;
  };
  // the largest factor whose counts are few enough, to a hundredth
  double low = 1e-6, high = 1e12;
  while (high > 1.01 * low) {
    const double middle = std::sqrt(low * high);
    (are_few_enough(middle) ? low : high) = middle;
  }
  std::vector<std::uint32_t> result(counts.size());
  for (std::size_t i = 0; i < counts.size(); ++i) result[i] = doublings.count(i, low);
  return result;
}

}  // namespace pvg
