// The Hessian of friction whose pull is an unknown of its own: what Newton's method needs to find the bend of the
// energy.
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>

#include "energies/contact/barrier.h"
#include "energies/contact/friction.h"
#include "host/device/device.hpp"
#include "host/geometry/mesh.hpp"

namespace pvg::primal_dual_friction_test {
namespace {

constexpr double H = 0.02, EPSILON = 1e-4 * H;  // [s], [m] sliding at which friction is fully developed
constexpr double FORCE = 3;                     // mu lambda [N]

using Hessian = Eigen::Matrix<double, 12, 12>;

// One point that slides on a plane z = 0, whose other sites stay.
class SlidingPoint {
 public:
  SlidingPoint()
      : program_(device_, "energies/contact/contact_terms.cl"), derivatives_(program_.kernel("contact_derivatives")) {
    Friction row{};
    for (u32 i = 0; i < 4; ++i) row.site[i] = i;
    row.coefficient[0] = 1;
    row.coefficient[1] = -1;
    row.normal[2] = 1;
    row.friction = 0.5;
    row.normal_force = FORCE / row.friction;
    row.friction_velocity = EPSILON / H;
    row_ = row;
  }

  // where it has slid to [m]
  void differentiate(const Vec3& sliding, bool begins) {
    std::vector<double> x(12, 0);
    Eigen::Map<Vec3>(x.data()) = sliding;
    const Buffer<Friction> rows(device_, std::vector<Friction>{row_}, "friction");
    const Buffer<Barrier> contacts(device_, 0, "contacts");
    const Buffer<u32> first_contact(device_, std::vector<u32>{0}, "first contact");
    const Buffer<double> now(device_, x, "x"), before(device_, std::vector<double>(12, 0), "x0");
    Buffer<double> gradient(device_, 12, "rows"), contact_blocks(device_, 0, "contact blocks"),
        blocks(device_, 144, "blocks");
    derivatives_(64, 64u, 1u, 0u, rows, 0u, first_contact, contacts, now, before, H, 0u, gradient, contact_blocks,
                 blocks, u32(begins), dual_);
    const std::vector<double> g = gradient.read(), b = blocks.read();
    this->gradient = Eigen::Map<const Vec3>(g.data());
    hessian = Eigen::Map<const Hessian>(b.data());
  }
  Vec3 pull() { return Eigen::Map<const Vec3>(dual_.read()[0].pull); }

  Vec3 gradient;
  Hessian hessian;

 private:
  Device device_;
  Program program_;
  Kernel derivatives_;
  Friction row_;
  Buffer<FrictionDual> dual_{device_, 1, "dual"};
};

// of FORCE f0(|u|), by its two directions in the plane, u along x
double along(double y) { return y < EPSILON ? FORCE * (2 - 2 * y / EPSILON) / EPSILON : 0; }
double across(double y) { return y < EPSILON ? FORCE * (2 - y / EPSILON) / EPSILON : FORCE / y; }

TEST(PrimalDualFriction, IsExactWhereItStays) {
  for (const double y : {0.3 * EPSILON, 0.9 * EPSILON, 50 * EPSILON}) {
    SlidingPoint point;
    point.differentiate({y, 0, 0}, true);
    for (int i = 0; i < 2; ++i) point.differentiate({y, 0, 0}, false);
    EXPECT_NEAR(point.hessian(0, 0), along(y), 1e-9 * across(y));
    EXPECT_NEAR(point.hessian(1, 1), across(y), 1e-9 * across(y));
    EXPECT_NEAR(point.hessian(0, 3), -along(y), 1e-9 * across(y));
    EXPECT_EQ(point.hessian(2, 2), 0);
  }
}

TEST(PrimalDualFriction, IsStiffWhereTheSlidingTurnsBack) {
  const double y = 40 * EPSILON;
  SlidingPoint point;
  point.differentiate({y, 0, 0}, true);
  EXPECT_NEAR(point.hessian(0, 0), 0, 1e-9 * FORCE / y);
  point.differentiate({-y, 0, 0}, false);
  EXPECT_NEAR(point.hessian(0, 0), 2 * FORCE / y, 1e-9 * FORCE / y);
  EXPECT_NEAR(point.gradient.x(), -FORCE, 1e-9);
}

TEST(PrimalDualFriction, IsPositiveWhateverTheWay) {
  SlidingPoint point;
  unsigned state = 7;
  const auto number = [&] { return (state = state * 1664525u + 1013904223u) / 4294967296.0 - 0.5; };
  point.differentiate({0, 0, 0}, true);
  for (int i = 0; i < 200; ++i) {
    const double size = EPSILON * std::pow(10, 4 * number());
    point.differentiate({size * number(), size * number(), 0}, false);
    EXPECT_LE(point.pull().norm(), 1 + 1e-12);
    const Eigen::Vector2d values =
        Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(point.hessian.topLeftCorner<2, 2>()).eigenvalues();
    EXPECT_GE(values[0], -1e-12 * values[1]);
  }
}

// The least of k |u - goal|^2 / 2 + FORCE f0(|u|) by whole steps from far away: pulled by less than friction bears it
// sticks, by more it slides. With the exact Hessian whole steps lead to and fro for ever.
TEST(PrimalDualFriction, NewtonFindsTheBendWithoutALineSearch) {
  const double k = 2000;  // [N/m]
  for (const double part : {0.4, 0.9, 1.1, 3.0}) {
    const Vec3 goal = part * FORCE / k * Vec3(0.6, 0.8, 0);
    Vec3 u = Vec3(2, -1, 0) * 500 * EPSILON;
    SlidingPoint point;
    int n = 0;
    for (double correction = INFINITY; correction > 1e-3 * EPSILON && n < 100; ++n) {
      point.differentiate(u, n == 0);
      const Eigen::Vector2d g = point.gradient.head<2>() + k * (u - goal).head<2>();
      const Eigen::Matrix2d matrix = point.hessian.topLeftCorner<2, 2>() + k * Eigen::Matrix2d::Identity();
      const Eigen::Vector2d step = -matrix.ldlt().solve(g);
      u.head<2>() += step;
      correction = step.norm();
    }
    EXPECT_LE(n, 15) << part;
    if (part < 1)
      EXPECT_LT(u.norm(), EPSILON) << part;
    else
      EXPECT_NEAR(u.norm(), (part - 1) * FORCE / k, 1e-9) << part;
  }
}

}  // namespace
}  // namespace pvg::primal_dual_friction_test
