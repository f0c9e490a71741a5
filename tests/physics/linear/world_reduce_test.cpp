// Sums per world: right for awkward sizes, and the same bits with and without companions.
#include "host/physics/linear/world_reduce.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace pvg {
namespace {

std::vector<double> random_values(std::size_t n, unsigned seed) {
  std::mt19937 rng(seed);
  std::normal_distribution<double> normal;
  std::vector<double> values(n);
  for (double& value : values) value = normal(rng);
  return values;
}

Site site_of(u32 node, double weight) { return {{node, 0, 0, 0}, {weight, 0, 0, 0}}; }

TEST(WorldReduce, SumEqualsAPlainLoop) {
  Device device;
  WorldReduce reduce(device, 1);
  WorldChunks chunks(device, 1);
  Buffer<f64> out(device, 1, "out");
  for (const u32 n : {0u, 1u, 3u, 257u, 1000u}) {
    const std::vector<double> a = random_values(n, n + 1);
    Buffer<f64> a_d(device, a, "a");
    const WorldRange range{0, 0, n};
    chunks.set(std::span(&range, 1));
    reduce.sum(chunks, a_d, out);
    double sum = 0, size = 0;
    for (const double value : a) {
      sum += value;
      size += std::abs(value);
    }
    EXPECT_NEAR(out.read()[0], sum, 1e-14 * size) << n;
  }
}

TEST(WorldReduce, LargestLengthOfKnownVectors) {
  Device device;
  WorldReduce reduce(device, 2);
  WorldChunks chunks(device, 2);
  Buffer<f64> out(device, 2, "out");
  Buffer<f64> a(device, std::vector<double>{3, 4, 0, 1, 0, 0, 0, -2, 0}, "a");
  const WorldRange ranges[] = {{0, 0, 1}, {1, 1, 3}};
  chunks.set(ranges);
  // the second site lies halfway between the nodes of the first and the third
  const Buffer<Site> sites(device, std::vector<Site>{site_of(0, 1), {{0, 2, 0, 0}, {0.5, 0.5, 0, 0}}, site_of(2, 1)},
                           "sites");
  reduce.largest_length(chunks, sites, a, out);
  EXPECT_EQ(out.read(), (std::vector<double>{5, 2}));
  const WorldRange halfway[] = {{0, 0, 1}, {1, 1, 2}};
  chunks.set(halfway);
  reduce.largest_length(chunks, sites, a, out);
  EXPECT_EQ(out.read()[0], 5);
  EXPECT_DOUBLE_EQ(out.read()[1], std::sqrt(1.5 * 1.5 + 1));  // a device may contract products and sums
}

TEST(WorldReduce, LargestLengthOfNotANumberIsInfinite) {
  Device device;
  WorldReduce reduce(device, 1);
  WorldChunks chunks(device, 1);
  Buffer<f64> out(device, 1, "out");
  Buffer<f64> a(device, std::vector<double>{1, 0, 0, std::nan(""), 0, 0, 1, 0, 0}, "a");
  const WorldRange range{0, 0, 3};
  chunks.set(std::span(&range, 1));
  const Buffer<Site> sites(device, std::vector<Site>{site_of(0, 1), site_of(1, 1), site_of(2, 1)}, "sites");
  reduce.largest_length(chunks, sites, a, out);
  EXPECT_EQ(out.read()[0], std::numeric_limits<double>::infinity());
}

TEST(WorldReduce, AWorldsBitsDoNotDependOnItsCompanions) {
  Device device;
  const u32 n_first = 391, n_second = 777;
  const std::vector<double> first = random_values(n_first, 1), second = random_values(n_second, 2);
  std::vector<double> both = first;
  both.insert(both.end(), second.begin(), second.end());

  WorldReduce pair(device, 2), alone(device, 1);
  WorldChunks pair_chunks(device, 2), alone_chunks(device, 1);
  Buffer<f64> pair_out(device, 2, "out"), alone_out(device, 1, "out");
  Buffer<f64> both_d(device, both, "a"), second_d(device, second, "a");
  const WorldRange ranges[] = {{0, 0, n_first}, {1, n_first, n_first + n_second}};
  const WorldRange own{0, 0, n_second};
  pair_chunks.set(ranges);
  alone_chunks.set(std::span(&own, 1));
  pair.sum(pair_chunks, both_d, pair_out);
  alone.sum(alone_chunks, second_d, alone_out);
  EXPECT_EQ(pair_out.read()[1], alone_out.read()[0]);
}

}  // namespace
}  // namespace pvg
