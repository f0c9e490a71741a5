// Between two states: the ends are the states, a quarter turn is halfway an eighth.
#include "host/render/motion.hpp"

#include <gtest/gtest.h>

namespace pvg {
namespace {

SceneState turned(double angle, double x) {
  SceneState state;
  state.time = x;
  AffineMap map;
  map.leftCols<3>() = Eigen::AngleAxisd(angle, Vec3::UnitZ()).toRotationMatrix();
  map.col(3) = Vec3(x, 0, 0);
  state.rigid = {map};
  state.soft = {{Vec3(x, 1, 2), Vec3(0, 0, 0)}};
  state.cloth = {{Vec3(0, x, 0)}};
  state.reading = {x};
  return state;
}

TEST(Motion, HalfwayIsHalfTheWayAndHalfTheTurn) {
  const SceneState a = turned(0, 0), b = turned(M_PI / 2, 4), middle = interpolate(a, b, 0.5);
  EXPECT_DOUBLE_EQ(middle.time, 2);
  EXPECT_NEAR(middle.rigid[0](0, 0), std::sqrt(0.5), 1e-12);
  EXPECT_NEAR(middle.rigid[0](1, 0), std::sqrt(0.5), 1e-12);
  EXPECT_NEAR(middle.rigid[0](0, 3), 2, 1e-12);
  EXPECT_EQ(middle.soft[0][0], Vec3(2, 1, 2));
  EXPECT_EQ(middle.cloth[0][0], Vec3(0, 2, 0));
  EXPECT_EQ(middle.reading, std::vector<double>{2});
  EXPECT_EQ(interpolate(a, b, 0).rigid[0], a.rigid[0]);
  EXPECT_EQ(interpolate(a, b, 1).rigid[0], b.rigid[0]);
}

TEST(Motion, StrainOfAnAffineBodyIsKept) {
  SceneState a = turned(0, 0), b = turned(1, 0);
  const Eigen::Matrix3d stretch = Vec3(1.1, 1, 0.9).asDiagonal();
  a.rigid[0].leftCols<3>() = a.rigid[0].leftCols<3>() * stretch;
  b.rigid[0].leftCols<3>() = b.rigid[0].leftCols<3>() * stretch;
  const Eigen::Matrix3d A = interpolate(a, b, 0.3).rigid[0].leftCols<3>();
  EXPECT_LT((A.transpose() * A - stretch * stretch).norm(), 1e-12);
}

}  // namespace
}  // namespace pvg
