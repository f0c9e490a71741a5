// Statistics of features against numbers by hand.
#include "host/dataset/feature_stats.hpp"

#include <gtest/gtest.h>

namespace pvg {
namespace {

TEST(FeatureStats, OfElevenNumbersAreThoseByHand) {
  const NumberStats stats = stats_of({10, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9});
  EXPECT_DOUBLE_EQ(stats.min, 0);
  EXPECT_DOUBLE_EQ(stats.max, 10);
  EXPECT_DOUBLE_EQ(stats.mean, 5);
  EXPECT_DOUBLE_EQ(stats.std, std::sqrt(10.0));  // (n^2 - 1) / 12
  EXPECT_NEAR(stats.quantiles[0], 0.1, 1e-12);
  EXPECT_NEAR(stats.quantiles[1], 1, 1e-12);
  EXPECT_NEAR(stats.quantiles[2], 5, 1e-12);
  EXPECT_NEAR(stats.quantiles[4], 9.9, 1e-12);
}

TEST(FeatureStats, OfPixelsAreOfEachChannelInUnitsOfWhite) {
  PixelCounts counts, more;
  counts.add(std::vector<std::uint8_t>{0, 51, 255, 0, 51, 255});
  more.add(std::vector<std::uint8_t>{255, 51, 255, 255, 51, 255});
  counts.add(more);
  const auto stats = counts.stats();
  EXPECT_DOUBLE_EQ(stats[0].mean, 0.5);
  EXPECT_DOUBLE_EQ(stats[0].std, 0.5);
  EXPECT_DOUBLE_EQ(stats[0].max, 1);
  EXPECT_NEAR(stats[1].mean, 0.2, 1e-15);
  EXPECT_NEAR(stats[1].std, 0, 1e-7);
  EXPECT_DOUBLE_EQ(stats[1].min, 0.2);
  EXPECT_DOUBLE_EQ(stats[2].quantiles[2], 1);
}

TEST(FeatureStats, JsonHasTheShapesThatReadersWantAndDeviationsThatCanBeDividedBy) {
  const std::vector<NumberStats> stats(3);
  const auto vector = to_json(stats, 7, false, std::vector<double>{0.01, 0.01, 0.001});
  EXPECT_EQ(vector["std"].dump(), "[0.01,0.01,0.001]");
  EXPECT_EQ(vector["count"].dump(), "[7]");
  const auto picture = to_json(stats, 7, true, {});
  EXPECT_EQ(picture["q99"].dump(), "[[[0.0]],[[0.0]],[[0.0]]]");
}

}  // namespace
}  // namespace pvg
