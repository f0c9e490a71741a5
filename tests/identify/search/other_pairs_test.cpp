// When two effects of which the first closes little are compared with others of as many on the held-out runs
#include <gtest/gtest.h>

#include "host/identify/fit/held_out.hpp"
#include "host/identify/search/prove.hpp"
#include "tests/identify/damped_pendulum.hpp"

namespace pvg::diagnose {
namespace {

constexpr double K = DampedPendulum::SPRING, C = DampedPendulum::DAMPING;
constexpr double ARM = 0.15;  // of the bar's drag [m]

struct OtherPairs : testing::Test {
  DampedPendulum pendulum;
  std::size_t n_simulations = 0;

  // Of each effect the first number; the others are as they are without it.
  Model model(const std::vector<std::pair<std::string, double>>& effects) const {
    std::vector<const Candidate*> parts;
    for (const auto& [name, x] : effects) parts.push_back(&pendulum.candidate(name));
    Model made = model_of(parts);
    Eigen::Index at = 0;
    for (std::size_t i = 0; i < parts.size(); at += Eigen::Index(parts[i++]->parameters.size()))
      made.x[at] = effects[i].second;
    return made;
  }

  // Of a spring that alone closes little, and with a damper.
  HeldOut judged(double damping, const std::vector<Model>& alternatives) {
    Predictor& predictor = pendulum.flow.predictor;
    const std::size_t before = predictor.n_simulations();
    HeldOut held_out = judge_held_out(
        pendulum.flow.fitter, pendulum.problem, 0, 2,
        {model({{"joint_spring", 0.3 * K}}), model({{"joint_spring", K}, {"joint_viscous_friction", damping}})}, true,
        alternatives);
    n_simulations = predictor.n_simulations() - before;
    return held_out;
  }
  const Model poor = model({{"joint_spring", 0.7 * K}, {"joint_coulomb_friction", 1e-3}});
  const Model better = model({{"joint_spring", K}, {"linear_drag", C / (ARM * ARM)}});
};

TEST_F(OtherPairs, AreNotSimulatedBesideWhatExplainsTheRuns) {
  const HeldOut held_out = judged(C, {});
  ASSERT_LT(held_out.after, criteria().unexplained);
  ASSERT_GT(n_simulations, 0U);
  EXPECT_TRUE(std::isinf(judged(C, {poor, better}).lead.at(1).sigma));
  EXPECT_EQ(n_simulations, 0U);  // what it predicted before is known, and the others are not asked for
}

TEST_F(OtherPairs, ThatExplainMoreWithholdTheName) {
  HeldOut held_out = judged(1.05 * C, {poor});
  const auto share = [&](double after) { return closed(held_out.before, after, held_out.floor); };
  ASSERT_GT(held_out.after, criteria().unexplained);
  ASSERT_LT(share(held_out.after_each.at(0)), criteria().gap_closed_least);
  ASSERT_GT(share(held_out.after), 0.84);
  EXPECT_GT(held_out.lead.at(1).sigma, criteria().gain_sigma);
  EXPECT_FALSE(std::isinf(held_out.lead.at(1).sigma));
  EXPECT_TRUE(closes_enough(held_out));
  EXPECT_FALSE(closes_enough(judged(1.05 * C, {})));  // nothing to compare it with
  held_out = judged(1.05 * C, {poor, better});
  EXPECT_LT(held_out.lead.at(1).sigma, 0) << held_out.after << " of " << held_out.before;
  EXPECT_EQ(held_out.lead.at(1).nearest, "joint_spring at hinge and linear_drag at bar");
  EXPECT_FALSE(closes_enough(held_out));
}

// Of which two do not close enough either
TEST_F(OtherPairs, ThreeEffectsAreComparedWithOthersToo) {
  const std::vector<Model> selected = {
      model({{"joint_spring", 0.3 * K}}), model({{"joint_spring", K}, {"joint_coulomb_friction", 0.03}}),
      model({{"joint_spring", K}, {"joint_coulomb_friction", 1e-6}, {"joint_viscous_friction", 1.05 * C}})};
  const HeldOut held_out = judge_held_out(pendulum.flow.fitter, pendulum.problem, 0, 2, selected, true);
  const auto share = [&](std::size_t m) { return closed(held_out.before, held_out.after_each.at(m), held_out.floor); };
  ASSERT_EQ(held_out.kept, 3U);
  ASSERT_LT(share(0), criteria().gap_closed_least);
  ASSERT_LT(share(1), share_of_effects(criteria().gap_closed_least, 2));
  ASSERT_GT(share(2), share_of_effects(criteria().gap_closed_least, 3));
  ASSERT_GT(held_out.after, criteria().unexplained);
  EXPECT_FALSE(closes_enough(held_out));  // nothing to compare it with
}

}  // namespace
}  // namespace pvg::diagnose
