// The lookup table against known responses, with noise and misaligned pixels; pool-adjacent-violators, the picture
// metrics and the alias table against numbers by hand.
#include "host/pictures/lut.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "host/base/error.hpp"
#include "host/pictures/picture_metrics.hpp"
#include "host/pictures/srgb.hpp"

namespace pvg {
namespace {

double response(double x, int c) { return std::pow(x, c == 0 ? 0.8 : c == 1 ? 1.1 : 1.4) * (c == 1 ? 0.9 : 1.0); }

// Smooth slopes with a few edges; the real one has the response, noise [of 8 bits] and a shift to the right [pixels].
PicturePair example(double noise, int shift) {
  PicturePair pair{240, 160, {}, {}};
  std::mt19937 random(5);
  std::normal_distribution<double> normal(0, 1);
  const auto scene = [](int x, int y, int c) {
    const double slope = 0.02 + 0.9 * (x % 80) / 80.0 * (0.4 + 0.6 * y / 160.0);
    return c == 1 ? 1 - slope : slope;
  };
  for (int y = 0; y < 160; ++y)
    for (int x = 0; x < 240; ++x)
      for (int c = 0; c < 3; ++c) {
        pair.rendered.push_back(float(scene(x, y, c)));
        const double clean = response(scene(std::max(0, x - shift), y, c), c);
        const double coded = linear_to_srgb(float(clean)) + noise / 255 * normal(random);
        pair.real.push_back(srgb_to_linear(std::round(float(std::clamp(coded, 0.0, 1.0)) * 255) / 255));
      }
  return pair;
}

double largest_error(const Lut& lut) {
  double error = 0;
  for (int i = 8; i < 230; ++i)
    for (int c = 0; c < 3; ++c)
      error = std::max(error, std::abs(lut.value[std::size_t(i)][std::size_t(c)] - response(i / 255.0, c)));
  return error;
}

Lut fitted(const PicturePair& pair) {
  const std::vector<std::vector<bool>> uses = {valid_pixels(pair)};
  return fit_lut(std::span(&pair, 1), uses);
}

TEST(Lut, FindsAKnownResponse) { EXPECT_LT(largest_error(fitted(example(0, 0))), 0.01); }

TEST(Lut, NoiseIsAveragedAndTheTableNeverFalls) {
  const Lut lut = fitted(example(4, 0));
  EXPECT_LT(largest_error(lut), 0.025);
  for (std::size_t i = 1; i < LUT_SIZE; ++i)
    for (std::size_t c = 0; c < 3; ++c) EXPECT_GE(lut.value[i][c], lut.value[i - 1][c]);
}

TEST(Lut, PixelsOffByOneAtEdgesDoNotBendIt) { EXPECT_LT(largest_error(fitted(example(0, 1))), 0.02); }

TEST(Lut, ThingsInOnePictureAloneAreLeftOut) {
  PicturePair pair = example(0, 0);
  for (int y = 20; y < 60; ++y)
    for (int x = 20; x < 70; ++x)
      for (int c = 0; c < 3; ++c) pair.real[std::size_t(3 * (y * 240 + x) + c)] = 0.3f;
  EXPECT_LT(largest_error(fitted(pair)), 0.02);
}

TEST(Lut, IsAppliedLinearlyBetweenItsEntriesAndEndsAreKept) {
  Lut lut;
  for (std::size_t i = 0; i < LUT_SIZE; ++i) lut.value[i] = {float(i) / 510, float(i) / 255, 1};
  std::vector<float> rgb = {0.5f, 0.123f, 0.2f, -1, 7, 0, NAN, 0.25f, 1};
  apply_lut(lut, rgb);
  EXPECT_NEAR(rgb[0], 0.25, 1e-6);
  EXPECT_NEAR(rgb[1], 0.123, 1e-6);
  EXPECT_EQ(rgb[2], 1);
  EXPECT_EQ(rgb[3], 0);
  EXPECT_EQ(rgb[4], 1);
  EXPECT_EQ(rgb[6], 0);
}

TEST(Lut, TooFewPixelsAreRefused) {
  PicturePair white{8, 8, std::vector<float>(192, 1.0f), std::vector<float>(192, 1.0f)};
  EXPECT_THROW(fitted(white), UsageError);
}

TEST(PoolAdjacentViolators, KeepsBlockMeansAndIsClosest) {
  const std::vector<double> values = {1, 3, 2, 2, 5, 4}, weights = {1, 1, 1, 2, 1, 3};
  const std::vector<double> y = pool_adjacent_violators(values, weights);
  // 3 2 2 pool to (3 + 2 + 4) / 4, 5 4 to (5 + 12) / 4
  const std::vector<double> expected = {1, 2.25, 2.25, 2.25, 4.25, 4.25};
  for (std::size_t i = 0; i < y.size(); ++i) EXPECT_NEAR(y[i], expected[i], 1e-12);
  EXPECT_TRUE(pool_adjacent_violators({}, {}).empty());
}

TEST(PictureMetrics, AgreeWithNumbersByHand) {
  const std::vector<float> a(16 * 16 * 3, 0.5f), b(16 * 16 * 3, 0.6f);
  EXPECT_NEAR(psnr(a, b), 20, 1e-4);  // mean square 0.01
  EXPECT_NEAR(ssim(a, a, 16, 16), 1, 1e-12);
  // flat pictures: only the luminance term (2 a b + c) / (a^2 + b^2 + c)
  EXPECT_NEAR(ssim(a, b, 16, 16), (2 * 0.3 + 1e-4) / (0.25 + 0.36 + 1e-4), 1e-6);
}

// expected: scikit-image 0.26, structural_similarity of the luma with gaussian_weights, sigma 1.5, sample covariance
// off, and peak_signal_noise_ratio, data range 1
TEST(PictureMetrics, AgreeWithScikitImage) {
  constexpr int WIDTH = 40, HEIGHT = 24;
  std::vector<float> a, b;
  for (int y = 0; y < HEIGHT; ++y)
    for (int x = 0; x < WIDTH; ++x)
      for (int c = 0; c < 3; ++c) {
        a.push_back(float((x * 7 + y * 5 + c * 17 + x * y) % 256) / 255.0f);
        b.push_back(float((x * 7 + y * 6 + c * 23 + x * y + 12) % 256) / 255.0f);
      }
  EXPECT_NEAR(psnr(a, b), 9.930607147710658, 1e-6);
  EXPECT_NEAR(ssim(a, b, WIDTH, HEIGHT), 0.46953043967409425, 1e-6);
}

}  // namespace
}  // namespace pvg
