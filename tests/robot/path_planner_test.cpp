// Ways around obstacles: what is found stays clear of a box by the points of the links themselves, where the straight
// way does not.
#include "host/robot/path_planner.hpp"

#include <gtest/gtest.h>

#include "host/geometry/primitive_shapes.hpp"
#include "host/robot/joint_path.hpp"

namespace pvg {
namespace {

struct Search : testing::Test {
  RobotModel arm = load_urdf(PVG_DATA_FOLDER "/robots/fr3/fr3.urdf");
  VectorXd from = (VectorXd(7) << -0.7, 0.3, 0, -1.8, 0, 2.1, 0.8).finished();
  VectorXd to = (VectorXd(7) << 0.7, 0.3, 0, -1.8, 0, 2.1, 0.8).finished();
  // a post between the two
  Eigen::AlignedBox3d post{Vec3(0.40, -0.05, 0), Vec3(0.50, 0.05, 0.7)};
  PathPlanner planner = PathPlanner(arm, arm.link("fr3_link8"), {}, {{"post", box(), Pose::Identity()}});

  TriangleMesh box() const {
    TriangleMesh mesh;
    for (int k = 0; k < 8; ++k) mesh.points.push_back(post.corner(Eigen::AlignedBox3d::CornerType(k)));
    mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                      {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
    return mesh;
  }
  // smallest distance of the links' vertices from the post
  double distance(const VectorXd& q) const {
    const std::vector<Pose> links = link_poses(arm, q);
    double smallest = 1;
    for (std::size_t i = 0; i < arm.links.size(); ++i)
      for (const Vec3& point : arm.links[i].collision.points)
        smallest = std::min(smallest, post.exteriorDistance(links[i] * point));
    return smallest;
  }
};

TEST_F(Search, GoesAroundAPostThatTheStraightWayMeets) {
  double straight = 1;
  for (int k = 0; k <= 100; ++k) straight = std::min(straight, distance(from + k / 100.0 * (to - from)));
  ASSERT_LT(straight, 1e-6);
  const auto knots = planner.plan(from, to);
  ASSERT_TRUE(knots.has_value());
  EXPECT_LT((knots->row(0).transpose() - from).norm(), 1e-12);
  EXPECT_LT((knots->bottomRows(1).transpose() - to).norm(), 1e-12);
  const JointPath path(*knots);
  for (int k = 0; k <= 500; ++k) {
    const VectorXd q = path.at(k / 500.0).q;
    ASSERT_GT(distance(q), 0.009) << k;  // 10 mm are kept where it is checked
    for (std::size_t i = 0; i < 7; ++i) {
      ASSERT_GE(q[Eigen::Index(i)], arm.joints[i].lower);
      ASSERT_LE(q[Eigen::Index(i)], arm.joints[i].upper);
    }
  }
}

TEST_F(Search, TheSameQuestionHasTheSameAnswer) {
  const auto first = planner.plan(from, to), second = planner.plan(from, to);
  ASSERT_TRUE(first && second);
  EXPECT_EQ(*first, *second);
}

TEST_F(Search, WhatCollidesIsNamedAndHasNoWay) {
  VectorXd into = from;
  into[0] = 0;
  const auto pair = planner.collision(into);
  ASSERT_TRUE(pair.has_value());
  EXPECT_EQ((*pair)[1], "post");
  EXPECT_FALSE(planner.plan(from, into).has_value());
  EXPECT_FALSE(planner.collision(from).has_value());
}

TEST_F(Search, AnArmFoldedIntoItselfCollides) {
  VectorXd folded(7);
  folded << 0, 1.78, 0, -3.0, 0, 0.6, 0;
  EXPECT_TRUE(planner.collision(folded).has_value());
}

}  // namespace
}  // namespace pvg
