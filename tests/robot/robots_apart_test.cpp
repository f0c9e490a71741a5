// Two arms are kept from each other: against the distance of the links' points, made here by hand.
#include "host/robot/robots_apart.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace pvg {
namespace {

struct RobotsApart : testing::Test {
  RobotModel arm = load_urdf(PVG_DATA_FOLDER "/robots/fr3/fr3.urdf");
  // side by side, 0.8 m apart, as on a table; both look along x
  Pose left_base = Pose(Eigen::Translation3d(0, 0.4, 0)), right_base = Pose(Eigen::Translation3d(0, -0.4, 0));
  VectorXd ready = (VectorXd(7) << 0, 0.3, 0, -1.8, 0, 2.1, 0.8).finished();

  std::vector<RobotShape> shapes(const std::vector<Obstacle>& of_left = {}) const {
    return {{"left", arm, left_base, arm.link("fr3_link8"), of_left},
            {"right", arm, right_base, arm.link("fr3_link8"), {}}};
  }
  // one stands; the other turns from outside to inside about its base's axis by 1 degree a step
  std::vector<Eigen::MatrixXd> sweep() const {
    std::vector<Eigen::MatrixXd> q(2, ready.transpose().replicate(121, 1));
    for (int k = 0; k <= 120; ++k) {
      q[0](k, 0) = -k * M_PI / 180;
      q[1](k, 0) = 30 * M_PI / 180;
    }
    return q;
  }
  std::vector<Vec3> points(const VectorXd& q, const Pose& base) const {
    const std::vector<Pose> links = link_poses(arm, q, base);
    std::vector<Vec3> all;
    for (std::size_t i = 0; i < arm.links.size(); ++i)
      for (const Vec3& point : arm.links[i].collision.points) all.push_back(links[i] * point);
    return all;
  }
  // smallest distance of the links' points: at least that of their surfaces
  double distance(const std::vector<Eigen::MatrixXd>& q, Eigen::Index step) const {
    const auto a = points(q[0].row(step), left_base), b = points(q[1].row(step), right_base);
    double smallest = 10;
    for (const Vec3& first : a)
      for (const Vec3& second : b) smallest = std::min(smallest, (first - second).norm());
    return smallest;
  }
};

TEST_F(RobotsApart, AreStoppedBeforeTheyMeet) {
  const auto q = sweep();
  double nearest = 1;
  for (Eigen::Index step = 0; step <= 120; ++step) nearest = std::min(nearest, distance(q, step));
  ASSERT_LT(nearest, 0.05);  // it does come among the other's links
  const auto found = first_encounter(shapes(), q);
  ASSERT_TRUE(found.has_value());
  EXPECT_EQ(found->first.substr(0, 5), "left/");
  EXPECT_EQ(found->second.substr(0, 6), "right/");
  // points of the links' meshes lie within 100 mm of each other on the surface
  EXPECT_LT(distance(q, Eigen::Index(found->step)), 0.1);
  for (std::size_t step = 0; step < found->step; ++step) ASSERT_GT(distance(q, Eigen::Index(step)), 0.01) << step;
}

TEST_F(RobotsApart, WhatAHandCarriesCountsToo) {
  // a rod of 300 mm along the flange's axis
  TriangleMesh rod;
  for (const double z : {0.0, 0.3})
    for (const Vec3& corner : {Vec3(-0.01, -0.01, z), Vec3(0.01, -0.01, z), Vec3(0, 0.01, z)})
      rod.points.push_back(corner);
  rod.triangles = {{0, 2, 1}, {3, 4, 5}, {0, 1, 4}, {0, 4, 3}, {1, 2, 5}, {1, 5, 4}, {2, 0, 3}, {2, 3, 5}};
  const auto without = first_encounter(shapes(), sweep());
  Pose sideways = Pose::Identity();
  std::optional<Encounter> with;
  for (const Vec3& axis : {Vec3(1, 0, 0), Vec3(-1, 0, 0), Vec3(0, 1, 0), Vec3(0, -1, 0)}) {
    sideways.linear() = Eigen::AngleAxisd(M_PI / 2, axis).toRotationMatrix();
    const auto found = first_encounter(shapes({{"rod", rod, sideways}}), sweep());
    if (found && (!with || found->step < with->step)) with = found;
  }
  ASSERT_TRUE(without && with);
  EXPECT_LT(with->step, without->step);
  EXPECT_EQ(with->first, "rod");
}

TEST_F(RobotsApart, ThatStayOnTheirSidesAreFree) {
  auto q = sweep();
  for (int k = 0; k <= 120; ++k) q[0](k, 0) = k * M_PI / 180 / 2;
  q[1].col(0).setConstant(-0.5);
  EXPECT_FALSE(first_encounter(shapes(), q).has_value());
}

TEST_F(RobotsApart, AnArmThatFoldsIntoItselfIsNamed) {
  auto q = sweep();
  q[0].col(0).setConstant(0.8);
  q[1].col(0).setConstant(-0.8);
  q[1].row(60) << 0, 1.78, 0, -3.0, 0, 0.6, 0;
  const auto found = first_encounter(shapes(), q);
  ASSERT_TRUE(found.has_value());
  EXPECT_EQ(found->step, 60u);
}

}  // namespace
}  // namespace pvg
