// Laws of joints given by formulas: V(q) = - integral of f(s, (s - q0) / h) from q0 to q, f by hand here.
#include "energies/joint/prismatic_law.h"
#include "energies/joint/revolute_law.h"
#include "host/physics/energies/laws.hpp"
#include "tests/physics/energies/joint_check.hpp"

namespace pvg::joint_law_test {
namespace {

const std::vector<std::string> VARIABLES = {"q", "v"};

std::string laws() {
  return law_cases("JOINT_LAWS", {parse_formula("c0 * sin(q) + c1 * v * fabs(v)", VARIABLES).kernel_text,
                                  parse_formula("c0 + c1 * q - c2 * tanh(v / 2)", VARIABLES).kernel_text});
}

double law(u32 number, const double* c, double q, double q0, double h) {
  const double v = (q - q0) / h;
  if (number == 0) return c[0] * (std::cos(q) - std::cos(q0)) - c[1] * h * std::pow(std::abs(v), 3) / 3;
  const double y = std::abs(v) / 2, log_cosh = y + std::log1p(std::exp(-2 * y)) - std::log(2.0);
  return -c[0] * (q - q0) - c[1] * (q * q - q0 * q0) / 2 + c[2] * h * 2 * log_cosh;
}

// d2V/dq2, or zero
double curvature(u32 number, const double* c, double q, double q0, double h) {
  const double v = (q - q0) / h;
  const double exact = number == 0 ? -c[0] * std::cos(q) - 2 * c[1] * std::abs(v) / h
                                   : -c[1] + c[2] / (2 * h * std::pow(std::cosh(v / 2), 2));
  return std::max(exact, 0.0);
}

double revolute_energy(const RevoluteLaw& p, const Vec3* x, const Vec3* x0, double) {
  return law(p.law, p.coefficient, host_revolute(x, x0, p.angle0), p.angle0 + p.lead, p.rate_length);
}

double prismatic_coordinate(const Vec3* x) { return (x[1] - x[0]).dot(x[2]); }

double prismatic_energy(const PrismaticLaw& p, const Vec3* x, const Vec3* x0, double) {
  return law(p.law, p.coefficient, prismatic_coordinate(x), prismatic_coordinate(x0) + p.lead, p.rate_length);
}

template <class Params>
void set_random(Params& p, Random& random) {
  p.law = random.number(0, 1) < 0.5;
  p.coefficient[0] = random.number(-5, 5);
  p.coefficient[1] = p.law ? random.number(-20, 20) : random.number(-0.02, 0.02);
  p.coefficient[2] = random.number(0, 5);
  p.lead = random.number(-0.02, 0.02);
  p.rate_length = random.number(0.005, 0.02);
}

template <class Params>
std::vector<EnergyElement<Params>> with_laws(std::vector<EnergyElement<Params>> elements) {
  Random random(41);
  for (auto& e : elements) set_random(e.params, random);
  return elements;
}

template <class Params>
void expect_term(EnergyCheck<Params>& check, const std::vector<EnergyElement<Params>>& elements) {
  check.set_energy_scale(10);  // the rule of integration is exact to a few 1e-9 J for the hyperbolic tangent
  check.expect_energy(elements);
  check.expect_gradient(elements);
  check.expect_symmetric_positive_hessian(elements);
  check.expect_awkward_sizes(elements);
}

TEST(JointLaw, EnergyAndGradientOfRevoluteJointsAgreeWithTheEnergyInDouble) {
  EnergyCheck<RevoluteLaw> check("joint/revolute_law", revolute_energy, 1e-6, "", laws());
  expect_term(check, with_laws(revolute_joints<RevoluteLaw>(1000, 0.1)));
}

TEST(JointLaw, EnergyAndGradientOfPrismaticJointsAgreeWithTheEnergyInDouble) {
  EnergyCheck<PrismaticLaw> check("joint/prismatic_law", prismatic_energy, 1e-7, "", laws());
  expect_term(check, with_laws(prismatic_joints<PrismaticLaw>(1000)));
}

TEST(JointLaw, CurvatureIsTheSecondDerivativeWhereThatIsPositive) {
  EnergyCheck<RevoluteLaw> revolute("joint/revolute_law", revolute_energy, 1e-6, "", laws());
  expect_gauss_newton<RevoluteLaw>(
      revolute, with_laws(revolute_joints<RevoluteLaw>(100, 0.01)),
      [](const RevoluteLaw& p, const Vec3* x, const Vec3* x0) { return host_revolute(x, x0, p.angle0); },
      [](const RevoluteLaw& p, double q, double) {
        return curvature(p.law, p.coefficient, q, p.angle0 + p.lead, p.rate_length);
      });
}

}  // namespace
}  // namespace pvg::joint_law_test
