// The check that all validation cases share, on states made by hand.
#include "pipeline/validation/step_check.hpp"
#include "host/model/scene.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "host/geometry/primitive_shapes.hpp"

namespace pvg {
namespace {

RigidBody unit_box(const std::string& name) {
  RigidBody body;
  body.name = name;
  body.collision = box_surface(Vec3(1, 1, 1));
  body.mass = body.volume = 1;
  body.inertia = Mat3::Identity() / 6;
  return body;
}

AffineMap at(double x) {
  AffineMap map = AffineMap::Identity();
  map(0, 3) = x;
  return map;
}

struct TwoBoxes {
  Scene scene;
  WorldState state;
  StepReport report;
  TwoBoxes() {
    scene.rigid_bodies = {unit_box("left"), unit_box("right")};
    state.rigid = {at(0), at(1.5)};
  }
  StepCounts look() const {
    StepCounts counts;
    StepCheck(scene).look(state, report, counts);
    return counts;
  }
};

TEST(StepCheck, BoxesApartAreSoundAndOverlappingOrTouchingOnesAreNot) {
  TwoBoxes boxes;
  EXPECT_EQ(boxes.look().intersecting, 0);
  EXPECT_TRUE(boxes.look().has_contact);
  for (const double x : {0.9, 1.0}) {
    boxes.state.rigid[1] = at(x);
    EXPECT_EQ(boxes.look().intersecting, 1) << x;
  }
  EXPECT_NE(boxes.look().first_fault.find("left"), std::string::npos);
  EXPECT_NE(boxes.look().first_fault.find("right"), std::string::npos);
}

TEST(StepCheck, ABodyAloneHasNothingToIntersect) {
  TwoBoxes boxes;
  boxes.scene.rigid_bodies.pop_back();
  EXPECT_FALSE(boxes.look().has_contact);
}

TEST(StepCheck, AStepAboveTheToleranceOrWithoutANumberIsNotConverged) {
  TwoBoxes boxes;
  boxes.report.residual = boxes.scene.solver.velocity_tolerance;
  EXPECT_EQ(boxes.look().unconverged, 0);
  for (const double residual :
       {1.01 * boxes.scene.solver.velocity_tolerance, std::numeric_limits<double>::quiet_NaN()}) {
    boxes.report.residual = residual;
    EXPECT_EQ(boxes.look().unconverged, 1) << residual;
  }
}

TEST(StepCheck, ASoftBodyThatFoldsThroughItselfIntersects) {
  Scene scene;
  scene.soft_bodies.resize(1);
  scene.soft_bodies[0].name = "bar";
  scene.soft_bodies[0].mesh = box_solid(Vec3(4, 1, 1), {8, 2, 2}, 4);
  WorldState state;
  state.soft = {scene.soft_bodies[0].mesh.points};
  StepCounts counts;
  StepCheck(scene).look(state, {}, counts);
  EXPECT_EQ(counts.intersecting + counts.inverted, 0);
  for (Vec3& x : state.soft[0])
    if (x.x() > 0.9) x = Vec3(-x.x(), x.y() + 0.3, x.z());  // its right end inside out and within its left one
  StepCheck(scene).look(state, {}, counts);
  EXPECT_EQ(counts.intersecting, 1);
  EXPECT_GT(counts.inverted, 0);
  EXPECT_EQ(counts.steps, 2);
}

TEST(StepCheck, AnElementIsUprightUntilACornerOrAMidpointCrossesOver) {
  for (const int nodes : {4, 10}) {
    TetMesh mesh = box_solid(Vec3(1, 1, 1), {1, 1, 1}, nodes);
    EXPECT_TRUE(is_upright(mesh, 0, mesh.points));
    const auto corner = [&](int k) -> Vec3& { return mesh.points[mesh.elements[k]]; };
    const Vec3 kept = corner(3), normal = (corner(1) - corner(0)).cross(corner(2) - corner(0));
    corner(3) -= 1.001 * (kept - corner(0)).dot(normal) / normal.squaredNorm() * normal;
    EXPECT_FALSE(is_upright(mesh, 0, mesh.points)) << nodes;
    corner(3) = kept;
    if (nodes == 4) continue;
    // A midpoint displaced by d edges along its edge 01 changes the Jacobian by 1 + 4 d (l0 - l1), which at the
    // quadrature point near corner 0, where l0 - l1 = 1 / sqrt 5, vanishes at d = -sqrt(5) / 4 = -0.559.
    for (const double d : {-0.55, -0.57}) {
      corner(4) = corner(0) + (0.5 + d) * (corner(1) - corner(0));
      EXPECT_EQ(is_upright(mesh, 0, mesh.points), d == -0.55) << d;
    }
  }
}

}  // namespace
}  // namespace pvg
