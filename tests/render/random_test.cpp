// Random numbers and the order of pixels: strata, bounds, independence of keys, and a bijection.
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "host/device/device.hpp"
#include "host/render/pixel_order.hpp"
#include "tests/render/test_scene.hpp"

namespace pvg {
namespace {

const char* const random_kernels = R"(
#include "shared/rng.cl"
kernel void draw(const uint n, const uint n_samples, global float* xy) {
  const uint i = get_global_id(0);
  if (i >= n) return;
  const uint set = i / n_samples;
  vstore2(sample_2d(hash_u32(set / 8), i % n_samples, set % 8), i, xy);
}
kernel void differ(const uint n, global uint* differences) {
  const uint i = get_global_id(0);
  if (i >= n) return;
  const uint key = hash_u32(i), sample = i % 97, dimension = i % 23;
  const float8 four = sample_2d_4(key, sample, dimension);
  const float2 points[4] = {four.s04, four.s15, four.s26, four.s37};
  uint count = 0;
  for (uint k = 0; k < 4; ++k) count += any(points[k] != sample_2d(key, sample, dimension + k)) ? 1 : 0;
  differences[i] = count;
}
kernel void differ_16(const uint n, global uint* differences) {
  const uint i = get_global_id(0);
  if (i >= n) return;
  uint key[16], sample[16];
  for (uint k = 0; k < 16; ++k) {
    key[k] = hash_u32(16 * i + k);
    sample[k] = (i + 31 * k) % 97;
  }
  float16 x, y;
  sample_2d_16(vload16(0, key), vload16(0, sample), i % 23, &x, &y);
  float xs[16], ys[16];
  vstore16(x, 0, xs);
  vstore16(y, 0, ys);
  uint count = 0;
  for (uint k = 0; k < 16; ++k) count += any((float2)(xs[k], ys[k]) != sample_2d(key[k], sample[k], i % 23)) ? 1 : 0;
  differences[i] = count;
})";

std::vector<float> draw(unsigned n_sets, unsigned n_samples) {
  Device device;
  const unsigned n = n_sets * n_samples;
  Buffer<float> xy(device, 2 * n, "xy");
  Program::from_text(device, "random", random_kernels).kernel("draw")(n, n, n_samples, xy);
  return xy.read();
}

TEST(Random, SixteenSamplesFillSixteenStrataInEachDirectionAndBoth) {
  const unsigned n_sets = test::is_simulated() ? 16 : 512;
  const std::vector<float> xy = draw(n_sets, 16);
  for (unsigned set = 0; set < n_sets; ++set) {
    unsigned columns = 0, rows = 0, cells = 0;
    for (unsigned i = 16 * set; i < 16 * set + 16; ++i) {
      const float x = xy[2 * i], y = xy[2 * i + 1];
      ASSERT_TRUE(x >= 0 && x < 1 && y >= 0 && y < 1);
      columns |= 1u << int(16 * x);
      rows |= 1u << int(16 * y);
      cells |= 1u << (4 * int(4 * x) + int(4 * y));
    }
    ASSERT_EQ(columns, 0xffffu);
    ASSERT_EQ(rows, 0xffffu);
    ASSERT_EQ(cells, 0xffffu);
  }
}

// first samples of many sets: uniform, and x, y and neighbouring dimensions are not correlated
using ManySets = test::ManyPaths;

TEST_F(ManySets, AreIndependent) {
  const unsigned n = 1 << 15;
  const std::vector<float> xy = draw(n, 1);
  double sum = 0, squares = 0, product = 0, next = 0;
  for (unsigned i = 0; i + 1 < n; ++i) {
    const double x = xy[2 * i] - 0.5, y = xy[2 * i + 1] - 0.5;
    sum += x;
    squares += x * x;
    product += x * y;
    next += x * (xy[2 * i + 2] - 0.5);
  }
  const double sigma = std::sqrt(double(n)) / 12;  // of a sum of n products of two uniform numbers
  EXPECT_NEAR(sum, 0, 4 * std::sqrt(n / 12.0));
  EXPECT_NEAR(squares / n, 1 / 12.0, 4 * std::sqrt(1 / 180.0 / n));
  EXPECT_NEAR(product, 0, 4 * sigma);
  EXPECT_NEAR(next, 0, 4 * sigma);
}

TEST(Random, PointsDrawnAtOnceAreThoseDrawnAlone) {
  Device device;
  const unsigned n = 4096;
  Buffer<unsigned> differences(device, n, "differences");
  Program program = Program::from_text(device, "random", random_kernels);
  program.kernel("differ")(n, n, differences);
  for (const unsigned count : differences.read()) ASSERT_EQ(count, 0u);
  program.kernel("differ_16")(n, n, differences);
  for (const unsigned count : differences.read()) ASSERT_EQ(count, 0u);
}

TEST(Tiles, EveryPixelComesOnce) {
  for (const auto& [width, height] : {std::pair{1u, 1u}, {8u, 8u}, {320u, 180u}, {13u, 7u}, {7u, 13u}, {257u, 3u}}) {
    const std::vector<std::uint32_t> places = tile_order(width, height);
    const std::set<std::uint32_t> distinct(places.begin(), places.end());
    EXPECT_EQ(places.size(), width * height);
    EXPECT_EQ(distinct.size(), width * height);
    EXPECT_EQ(*distinct.rbegin(), width * height - 1);
  }
}

TEST(Tiles, SixtyFourNeighboursInTheListAreATile) {
  const std::vector<std::uint32_t> places = tile_order(320, 180);
  for (std::size_t i = 0; i < 64; ++i) {
    EXPECT_LT(places[64 + i] / 320, 8u);  // the second tile
    EXPECT_EQ(places[64 + i] % 320 / 8, 1u);
  }
}

}  // namespace
}  // namespace pvg
