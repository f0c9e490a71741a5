// Smoothed Coulomb friction of a lagged contact: E = mu lambda f0(|u|)
#include "energies/contact/friction.h"

#include "tests/physics/energies/energy_check.hpp"

namespace pvg::friction_test {
namespace {

using Element = EnergyElement<Friction>;

// along two tangents that are made here, so that the projector is not repeated
double energy(const Friction& p, const Vec3* x, const Vec3* x0, double h) {
  const Vec3 normal(p.normal[0], p.normal[1], p.normal[2]);
  const Vec3 t1 = normal.unitOrthogonal(), t2 = normal.cross(t1);
  Vec3 moved = Vec3(p.anchor[0], p.anchor[1], p.anchor[2]);
  for (int i = 0; i < 4; ++i) moved += p.coefficient[i] * (x[i] - x0[i]);
  const double y = std::hypot(moved.dot(t1), moved.dot(t2)), eps = p.friction_velocity * h;
  const double f0 = y < eps ? -y * y * y / (3 * eps * eps) + y * y / eps + eps / 3 : y;
  return p.friction * p.normal_force * f0;
}

constexpr double STEP = 1e-8;      // [m]
constexpr double VELOCITY = 0.01;  // [m/s]; sliding turns full at 0.125 mm with the check's step

// sliding: largest shift of a site [m]
std::vector<Element> contacts(std::size_t n, double sliding) {
  Random random(3);
  std::vector<Element> elements(n);
  for (Element& e : elements) {
    Friction& p = e.params;
    p.friction = random.number(0, 1.5);
    p.normal_force = random.number(0, 20);
    p.friction_velocity = VELOCITY;
    const Vec3 normal = random.vector(1).normalized();
    const Vec3 anchor = normal.unitOrthogonal() * random.number(0, 0.5 * sliding);
    for (int k = 0; k < 3; ++k) {
      p.normal[k] = normal[k];
      p.anchor[k] = anchor[k];
    }
    const double s = random.number(0, 1), t = random.number(0, 1);
    p.kind = random.number(0, 1) < 0.5;
    const double c[2][4] = {{1, -s * t, -s * (1 - t), s - 1}, {1 - s, s, t - 1, -t}};
    std::copy_n(c[p.kind], 4, p.coefficient);
    for (int i = 0; i < 4; ++i) {
      e.x0.push_back(random.vector(0.01));
      e.x.push_back(e.x0[i] + random.vector(sliding));
    }
  }
  return elements;
}

EnergyCheck<Friction> make_check() {
  EnergyCheck<Friction> check("contact/friction", energy, STEP);
  check.set_energy_scale(1e-4);
  return check;
}

TEST(Friction, EnergyGradientAndHessianAgreeWithTheEnergyInDouble) {
  EnergyCheck<Friction> check = make_check();
  for (const double sliding : {3e-5, 1e-3}) {  // sticking, slipping
    const std::vector<Element> elements = contacts(1000, sliding);
    check.expect_energy(elements);
    check.expect_gradient(elements);
    check.expect_exact_hessian({elements.begin(), elements.begin() + 100}, 1e-5);
    check.expect_symmetric_positive_hessian(elements);
    check.expect_awkward_sizes(elements);
    check.expect_no_net_force(elements);
  }
}

TEST(Friction, HessianAtRestIsTwiceTheForceOverTheTransition) {
  EnergyCheck<Friction> check = make_check();
  Element e = contacts(1, 0)[0];
  e.params.friction = 0.5;
  e.params.normal_force = 4;
  const double c[4] = {1, -0.25, -0.25, -0.5}, normal[3] = {0, 0, 1};
  std::copy_n(c, 4, e.params.coefficient);
  std::copy_n(normal, 3, e.params.normal);
  std::fill_n(e.params.anchor, 3, 0);
  const EnergyResult r = check.evaluate({e})[0];
  EXPECT_EQ(r.gradient.norm(), 0);
  EXPECT_NEAR(r.hessian(0, 0), 2 * 0.5 * 4 / (VELOCITY * check.H), 1e-6);
  EXPECT_EQ(r.hessian(2, 2), 0);  // nothing along the normal
}

TEST(Friction, SlidingIsResistedByTheCoefficientTimesTheNormalForce) {
  EnergyCheck<Friction> check = make_check();
  for (const Element& e : contacts(100, 0.1)) {
    const EnergyResult r = check.evaluate({e})[0];
    Vec3 moved = Vec3(e.params.anchor[0], e.params.anchor[1], e.params.anchor[2]);
    for (int i = 0; i < 4; ++i) moved += e.params.coefficient[i] * (e.x[i] - e.x0[i]);
    const Vec3 normal(e.params.normal[0], e.params.normal[1], e.params.normal[2]);
    const Vec3 tangential = moved - moved.dot(normal) * normal;
    if (tangential.norm() < VELOCITY * check.H) continue;
    Vec3 force = r.gradient.head<3>();
    if (e.params.kind == 1) force += r.gradient.segment<3>(3);
    EXPECT_NEAR(force.norm(), e.params.friction * e.params.normal_force, 1e-9);
    EXPECT_NEAR(force.normalized().dot(tangential.normalized()), 1, 1e-12);
  }
}

}  // namespace
}  // namespace pvg::friction_test
