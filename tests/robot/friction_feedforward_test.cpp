// What targets lead, by hand: at a steady rate the drive's spring carries the friction.
#include "host/robot/friction_feedforward.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace pvg {
namespace {

constexpr double STIFFNESS = 400, RATE = 0.5, STEP = 0.02;

const std::vector<Effect> FRICTION = {{"joint_viscous_friction", "elbow", {50}},
                                      {"joint_coulomb_friction", "elbow", {8, 1e-3}},
                                      {"joint_viscous_friction", "wrist", {1000}},
                                      {"rotor_inertia", "elbow", {3}}};

Joint elbow(double damping, Drive::DampedRate rate = Drive::DampedRate::error) {
  Joint joint;
  joint.name = "elbow";
  joint.drive.stiffness = STIFFNESS;
  joint.drive.damping = damping;
  joint.drive.damped_rate = rate;
  return joint;
}

// forth at RATE, then at rest
std::vector<double> lead_of(const Joint& joint, const std::vector<Effect>& effects = FRICTION, int steps = 200) {
  std::vector<double> q;
  for (int i = 1; i <= 2 * steps; ++i) q.push_back(0.1 + RATE * STEP * std::min(i, steps));
  return friction_lead(joint, effects, 0.1, q, STEP);
}

TEST(FrictionFeedforward, TheSpringOfTheDriveCarriesTheFriction) {
  const std::vector<double> lead = lead_of(elbow(0));
  EXPECT_NEAR(lead.front(), (50 * RATE + 8) / STIFFNESS, 1e-12);
  EXPECT_NEAR(lead[199], (50 * RATE + 8) / STIFFNESS, 1e-12);
  EXPECT_EQ(lead[200], 0);  // at rest nothing is held back
}

// d de/dt + k e = F: e = F / k (1 - exp(-k t / d))
TEST(FrictionFeedforward, ADriveThatDampsItsErrorNeedsTheLeadByAndBy) {
  const double damping = 40, final_lead = (50 * RATE + 8) / STIFFNESS;
  const std::vector<double> lead = lead_of(elbow(damping));
  for (const int i : {4, 9, 24, 199})
    EXPECT_NEAR(lead[std::size_t(i)], final_lead * (1 - std::exp(-STIFFNESS * STEP * (i + 1) / damping)),
                0.04 * final_lead);  // the error of implicit Euler at a fifth of the time constant
  EXPECT_LT(lead[220], 0.05 * final_lead);
}

TEST(FrictionFeedforward, ADriveThatDampsTheJointHoldsItBackToo) {
  EXPECT_NEAR(lead_of(elbow(40, Drive::DampedRate::joint))[0], ((50 + 40) * RATE + 8) / STIFFNESS, 1e-12);
}

TEST(FrictionFeedforward, BelowItsRoundingFrictionGrowsWithTheRate) {
  const std::vector<Effect> rounded = {{"joint_coulomb_friction", "elbow", {8, 2 * RATE}}};
  EXPECT_NEAR(lead_of(elbow(0), rounded)[0], 8 * 0.75 / STIFFNESS, 1e-12);  // s(eps / 2) = 3 / 4
}

TEST(FrictionFeedforward, IsZeroWithoutFrictionOrWithoutAPositionToHold) {
  Joint torque = elbow(0);
  torque.drive.mode = Drive::Mode::torque;
  for (const std::vector<double>& lead : {lead_of(elbow(40), {}), lead_of(torque)})
    for (const double e : lead) EXPECT_EQ(e, 0);
}

}  // namespace
}  // namespace pvg
