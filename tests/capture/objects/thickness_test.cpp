// Thickness of walls, and what a report says of an object.
#include "host/capture/objects/thickness.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "host/capture/objects/object.hpp"
#include "host/geometry/primitive_shapes.hpp"

namespace pvg {
namespace {

// A plate of 0.8 mm: two of its six faces are as thick as that, the others 40 and 60 mm.
const Vec3 PLATE(0.04, 0.06, 0.0008);

TEST(Thickness, APlateIsAsThickAsItIs) {
  const std::vector<WallThickness> walls = wall_thickness(box_surface(PLATE, {4, 6, 1}));
  ASSERT_EQ(walls.size(), 2u * 2 * (4 * 6 + 4 + 6));
  EXPECT_NEAR(walls.front().thickness, PLATE.z(), 1e-12);
  EXPECT_NEAR(walls.back().thickness, PLATE.y(), 1e-12);
  const double broad = PLATE.x() * PLATE.y(), narrow = (PLATE.x() + PLATE.y()) * PLATE.z();
  EXPECT_NEAR(share_thinner(walls, 1e-3), broad / (broad + narrow), 1e-9);
  EXPECT_EQ(share_thinner(walls, 0.7e-3), 0);
}

TEST(Thickness, TheReportHasItAndTheHistogramOfDistances) {
  CapturedObject object;
  object.simulation = box_surface(PLATE, {4, 6, 1});
  object.to_source = {0.05e-3, 0.25e-3, 0.25e-3, 1.6e-3};
  const nlohmann::ordered_json report = object_report(object, {}, 1);
  EXPECT_NEAR(report["thickness"]["least"].get<double>(), PLATE.z(), 1e-12);
  EXPECT_EQ(report["thickness"]["activation_distance"], 1e-3);
  EXPECT_GT(report["thickness"]["share_below"].get<double>(), 0.9);
  const nlohmann::ordered_json& histogram = report["distance"]["histogram"];
  EXPECT_EQ(histogram["counts"].size(), 16u);
  EXPECT_EQ(histogram["counts"][0], 1);
  EXPECT_EQ(histogram["counts"][2], 2);
  EXPECT_EQ(histogram["counts"][15], 1);  // the largest one is in the last
  EXPECT_NEAR(histogram["width"].get<double>(), 0.1e-3, 1e-12);
}

}  // namespace
}  // namespace pvg
