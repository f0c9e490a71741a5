// Moments and overlap of masks, by hand.
#include "host/pictures/mask_metrics.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "host/base/error.hpp"

namespace pvg {
namespace {

TEST(MaskMetrics, MomentsOfOnePixelByHand) {
  // 4 x 2 pixels, the one at the upper right: x = 3/4, y = -1/2, an eighth of the picture
  const std::vector<std::uint8_t> mask = {0, 0, 0, 1, 0, 0, 0, 0};
  const auto m = mask_moments(mask, 4, 2);
  EXPECT_DOUBLE_EQ(m[0], 1.0 / 8);
  EXPECT_DOUBLE_EQ(m[1], 0.75 / 8);
  EXPECT_DOUBLE_EQ(m[2], -0.5 / 8);
  EXPECT_DOUBLE_EQ(m[3], 0.5625 / 8);
  EXPECT_DOUBLE_EQ(m[4], -0.375 / 8);
  EXPECT_DOUBLE_EQ(m[5], 0.25 / 8);
}

TEST(MaskMetrics, AFullMaskHasTheMomentsOfTheSquare) {
  // of [-1, 1]^2: 1, 0, 0, 1/3, 0, 1/3, less what the middles of 100 pixels miss, (1 - 1/100^2)/3
  const auto m = mask_moments(std::vector<std::uint8_t>(10000, 1), 100, 100);
  EXPECT_DOUBLE_EQ(m[0], 1);
  EXPECT_NEAR(m[1], 0, 1e-12);
  EXPECT_NEAR(m[4], 0, 1e-12);
  EXPECT_NEAR(m[3], (1 - 1e-4) / 3, 1e-12);
  EXPECT_NEAR(m[5], (1 - 1e-4) / 3, 1e-12);
}

TEST(MaskMetrics, OverlapIsSharedOverCovered) {
  const std::vector<std::uint8_t> a = {1, 1, 1, 0, 0, 0}, b = {0, 1, 1, 1, 0, 0}, none(6, 0);
  EXPECT_DOUBLE_EQ(mask_overlap(a, b), 2.0 / 4);
  EXPECT_DOUBLE_EQ(mask_overlap(a, a), 1);
  EXPECT_DOUBLE_EQ(mask_overlap(a, none), 0);
  EXPECT_DOUBLE_EQ(mask_overlap(none, none), 1);
  EXPECT_THROW(mask_overlap(a, std::vector<std::uint8_t>(5, 1)), Failure);
}

}  // namespace
}  // namespace pvg
