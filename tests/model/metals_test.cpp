// Measured metals: Fresnel's equations against numbers by hand, and how far the renderer's curve is from them.
#include "host/model/metals.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace pvg {
namespace {

double square(double x) { return x * x; }

std::size_t index_of(const std::string& name) {
  for (std::size_t i = 0; i < metal_names().size(); ++i)
    if (metal_names()[i] == name) return i;
  ADD_FAILURE() << name;
  return 0;
}

TEST(Metals, FresnelsEquationsAtNormalIncidenceAtTheEdgeAndOfADielectric) {
  // ((n - 1)^2 + k^2) / ((n + 1)^2 + k^2)
  EXPECT_NEAR(fresnel_conductor(0.2, 3.4, 1), (square(0.8) + square(3.4)) / (square(1.2) + square(3.4)), 1e-12);
  EXPECT_NEAR(fresnel_conductor(1.5, 5, 0), 1, 1e-12);
  // without absorption at Brewster's angle only the s polarised half is left: ((n^2 - 1) / (n^2 + 1))^2 of it
  const double n = 1.5, brewster = std::cos(std::atan(n));
  EXPECT_NEAR(fresnel_conductor(n, 0, brewster), 0.5 * square((n * n - 1) / (n * n + 1)), 1e-12);
}

// The exact curve and what the renderer makes of it: at most 0.025 apart in any channel at any angle (chromium, at
// grazing angles); Schlick's curve alone is off by up to 0.20.
TEST(Metals, TheRenderersCurveIsNearTheExactOne) {
  double worst = 0, worst_of_schlick = 0;
  for (std::size_t i = 0; i < metal_names().size(); ++i) {
    const Vec3 normal = metal_reflectance(i, 1), dip = metal_edge_dip(i);
    for (int step = 0; step <= 50; ++step) {
      const double c = step / 50.0;
      const Vec3 exact = metal_reflectance(i, c), schlick = normal + std::pow(1 - c, 5) * (Vec3::Ones() - normal);
      const Vec3 ours = schlick - c * std::pow(1 - c, 6) * dip;
      worst = std::max(worst, (ours - exact).cwiseAbs().maxCoeff());
      worst_of_schlick = std::max(worst_of_schlick, (schlick - exact).cwiseAbs().maxCoeff());
      EXPECT_GE(ours.minCoeff(), 0) << metal_names()[i];
      EXPECT_LE(ours.maxCoeff(), 1 + 1e-9) << metal_names()[i];
    }
  }
  EXPECT_LE(worst, 0.026);
  EXPECT_GE(worst, 0.02);  // the figure of the comment
  EXPECT_NEAR(worst_of_schlick, 0.2, 0.01);
}

TEST(Metals, ColoursAreThoseOfTheMetals) {
  const Vec3 gold = metal_reflectance(index_of("gold"), 1), copper = metal_reflectance(index_of("copper"), 1),
             silver = metal_reflectance(index_of("silver"), 1), aluminium = metal_reflectance(index_of("aluminium"), 1);
  EXPECT_GT(gold.x(), gold.y() + 0.2);
  EXPECT_GT(gold.y(), gold.z() + 0.3);
  EXPECT_GT(copper.x(), copper.y() + 0.25);
  EXPECT_GT(silver.minCoeff(), 0.97);
  // aluminium is nearly grey: between its reflectance at 477 nm and at 620 nm, by hand from n and k
  const double blue = (square(0.7278 - 1) + square(5.7781)) / (square(0.7278 + 1) + square(5.7781));
  const double red = (square(1.366 - 1) + square(7.4052)) / (square(1.366 + 1) + square(7.4052));
  EXPECT_NEAR(aluminium.x(), red, 0.005);
  EXPECT_NEAR(aluminium.z(), blue, 0.005);
}

}  // namespace
}  // namespace pvg
