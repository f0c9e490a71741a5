// Adaptive sampling: counts by hand, a sum that is never exceeded, noise that falls where it was, and nothing where
// there is none.
#include "host/render/adaptive.hpp"

#include <gtest/gtest.h>

#include <numeric>

#include "tests/render/test_scene.hpp"

namespace pvg::test {
namespace {

std::uint64_t sum(const std::vector<std::uint32_t>& counts) {
  return std::accumulate(counts.begin(), counts.end(), std::uint64_t(0));
}

// best counts of 40 paths are in proportion to the roots 1 and 4: 8 and 32
TEST(DoubledCounts, AreInProportionToTheRootOfTheVariance) {
  EXPECT_EQ(doubled_counts({1, 16}, {4, 4}, 40), (std::vector<std::uint32_t>{8, 32}));
}

TEST(DoubledCounts, LeavePixelsWithoutNoiseAlone) {
  EXPECT_EQ(doubled_counts({0, 1, 0, 1}, {4, 4, 4, 4}, 64), (std::vector<std::uint32_t>{4, 16, 4, 16}));
  EXPECT_EQ(doubled_counts({0, 0}, {4, 4}, 1000000), (std::vector<std::uint32_t>{4, 4}));
}

TEST(DoubledCounts, NeverExceedTheSumAndNeverFall) {
  std::mt19937 random(1);
  std::lognormal_distribution<float> variance(0, 3);
  for (int k = 0; k < 20; ++k) {
    std::vector<float> variances(1000);
    std::vector<std::uint32_t> counts(1000);
    for (std::size_t i = 0; i < counts.size(); ++i) {
      variances[i] = variance(random);
      counts[i] = 4u << random() % 3;
    }
    const std::uint64_t total = sum(counts) + random() % 20000;
    const std::vector<std::uint32_t> doubled = doubled_counts(variances, counts, total);
    EXPECT_LE(sum(doubled), total);
    for (std::size_t i = 0; i < counts.size(); ++i) {
      EXPECT_GE(doubled[i], counts[i]);
      EXPECT_EQ(doubled[i] % counts[i], 0u);
    }
  }
}

// grey paths 0 and 1 of one pixel: their variance is 1/2, their mean 1/2, so v = 0.5 / (0.25 + 0.01 / exposure^2)
TEST(PathVariances, OfTwoPathsByHand) {
  const std::vector<F32x4> film = {{{1, 1, 1, 2}}};
  EXPECT_NEAR(path_variances(film, {1}, 1, 1)[0], 0.5 / 0.26, 1e-5);
  EXPECT_NEAR(path_variances(film, {1}, 1, 0.5f)[0], 0.5 / 0.29, 1e-5);
}

// one noisy pixel among 9 x 9 is shared by the 5 x 5 around it, and no further
TEST(PathVariances, AreSharedByNeighbours) {
  std::vector<F32x4> film(81, F32x4{{2, 2, 2, 2}});
  std::vector<float> squares(81, 2);
  squares[4 * 9 + 4] = 4;  // of paths with variance 2
  const std::vector<float> v = path_variances(film, squares, 9, 1);
  for (int y = 0; y < 9; ++y)
    for (int x = 0; x < 9; ++x)
      EXPECT_NEAR(v[std::size_t(y * 9 + x)], std::abs(x - 4) <= 2 && std::abs(y - 4) <= 2 ? 2 / 25.0 / 1.01 : 0, 1e-5);
}

RenderedFrame shot(const Scene& scene, int samples, bool is_adaptive, std::uint64_t seed) {
  Device device;
  return Renderer(device, scene, RenderSettings{.samples = samples, .is_adaptive = is_adaptive, .seed = seed})
      .render(0, 0);
}

double squared_error(const RenderedFrame& a, const RenderedFrame& truth) {
  double sum = 0;
  for (std::size_t i = 0; i < a.rgb.size(); ++i) sum += std::pow(double(a.rgb[i]) - double(truth.rgb[i]), 2);
  return sum / double(a.rgb.size());
}

// A ball below a small lamp fills a fifth of the picture; the rest is an even sky without noise.
Scene ball_in_the_sky() {
  Scene scene;
  add(scene, sphere(0.4f, 24), material(VisualMaterial::Kind::diffuse, {0.7f, 0.7f, 0.7f}));
  add_light(scene, {-1, -1, 1.5}, {0, 0.5, 0}, {0.5, 0, 0}, Vec3f::Constant(20));
  scene.environment = Vec3f::Constant(0.3f);
  look_at(scene, {0, -3, 0}, {0, 0, 0}, 64, 64, 60);
  return scene;
}

struct AdaptiveSampling : ManyPaths {};

TEST_F(AdaptiveSampling, HalvesTheErrorWhereMostOfThePictureHasNone) {
  const Scene scene = ball_in_the_sky();
  const RenderedFrame truth = shot(scene, 1024, false, 7);
  double even = 0, adaptive = 0;
  for (const std::uint64_t seed : {1, 2, 3, 4}) {
    even += squared_error(shot(scene, 16, false, seed), truth);
    adaptive += squared_error(shot(scene, 16, true, seed), truth);
  }
  std::printf("squared error: even %.3g, adaptive %.3g\n", even, adaptive);
  EXPECT_LT(adaptive, 0.5 * even);
}

TEST_F(AdaptiveSampling, KeepsTheMean) {
  const Scene scene = ball_in_the_sky();
  const double truth = mean(shot(scene, 1024, false, 7)).value;
  double total = 0;
  for (std::uint64_t seed = 1; seed <= 8; ++seed) total += mean(shot(scene, 16, true, seed)).value;
  EXPECT_NEAR(total / 8, truth, 0.002 * truth);
}

TEST_F(AdaptiveSampling, GivesTheSameBitsTwice) {
  const Scene scene = ball_in_the_sky();
  EXPECT_EQ(shot(scene, 9, true, 3).rgb, shot(scene, 9, true, 3).rgb);
}

// so few that all of them go to all pixels
TEST(AdaptiveSamples, OfFourAreEven) {
  const Scene scene = ball_in_the_sky();
  EXPECT_EQ(shot(scene, 4, true, 3).rgb, shot(scene, 4, false, 3).rgb);
}

}  // namespace
}  // namespace pvg::test
