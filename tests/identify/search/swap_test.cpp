#include "host/identify/fit/swap.hpp"

#include <gtest/gtest.h>

#include "host/identify/search/pairs.hpp"

namespace pvg::diagnose {
namespace {

Candidate with_parameters(const char* name, std::size_t n) {
  Candidate candidate;
  candidate.name = name;
  candidate.parameters.assign(n, {"strength", "1", 0, 100, 0, 1});
  return candidate;
}

struct Swap : testing::Test {
  Candidate lag = with_parameters("lag", 1), spring = with_parameters("spring", 2), delay = with_parameters("delay", 1),
            force = with_parameters("force", 3);
  Model lag_and_spring{{&lag, &spring}, Eigen::Vector3d(1, 2, 3), Eigen::Vector3d(0.1, 0.2, 0.3)};
  Fit of(const Candidate& first, const Candidate& last, const Eigen::VectorXd& x) {
    Fit fit;
    fit.model = {{&first, &last}, x, 0.1 * x};
    return fit;
  }
};

TEST_F(Swap, WhatIsLeftOutTakesItsNumbersAlong) {
  const Model spring_alone = without(lag_and_spring, 0);
  EXPECT_EQ(spring_alone.parts, std::vector<const Candidate*>{&spring});
  EXPECT_EQ(spring_alone.x, Eigen::Vector2d(2, 3));
  EXPECT_EQ(spring_alone.scale, Eigen::Vector2d(0.2, 0.3));
  EXPECT_EQ(without(lag_and_spring, 1).x, Eigen::VectorXd::Constant(1, 1));
}

TEST_F(Swap, EachEffectIsLeftOutInTurnTheNewestTooAndNoNuisance) {
  Candidate mass = with_parameters("mass", 1);
  mass.is_nuisance = true;
  const Model model{{&mass, &lag, &spring}, Eigen::Vector4d(5, 1, 2, 3), Eigen::Vector4d::Ones()};
  const std::vector<Model> simpler = each_left_out(model);
  ASSERT_EQ(simpler.size(), 2u);
  EXPECT_EQ(simpler[0].parts, (std::vector<const Candidate*>{&mass, &spring}));
  EXPECT_EQ(simpler[0].x, Eigen::Vector3d(5, 2, 3));
  EXPECT_EQ(simpler[1].parts, (std::vector<const Candidate*>{&mass, &lag}));
  EXPECT_EQ(simpler[1].x, Eigen::Vector2d(5, 1));
}

TEST_F(Swap, AnotherPartComesWithItsOwnNumbersAndTheRestKeepsIts) {
  const Fit lag_and_force = of(lag, force, Eigen::Vector4d(9, 4, 5, 6));
  const Model lag_swapped_in = replaced(lag_and_spring, 0, lag_and_force.model);
  EXPECT_EQ(lag_swapped_in.parts, (std::vector<const Candidate*>{&force, &spring}));
  EXPECT_EQ(lag_swapped_in.x, (Eigen::VectorXd(5) << 4, 5, 6, 2, 3).finished());
  const Model spring_swapped_in = replaced(lag_and_spring, 1, lag_and_force.model);
  EXPECT_EQ(spring_swapped_in.parts, (std::vector<const Candidate*>{&lag, &force}));
  EXPECT_EQ(spring_swapped_in.x, Eigen::Vector4d(1, 4, 5, 6));
  EXPECT_TRUE(spring_swapped_in.scale.isApprox(Eigen::Vector4d(0.1, 0.4, 0.5, 0.6)));
}

TEST_F(Swap, NumbersAreThoseOfTheSamePartsAndOfTheSameNameAtTheSameTarget) {
  Candidate dry = with_parameters("dry", 1), stribeck = with_parameters("stribeck", 2),
            wide = with_parameters("wide", 1);
  stribeck.parameters[0].name = "extra";  // its second one is named as that of `dry`
  wide.target = "elsewhere";
  const Model model{{&dry, &lag}, Eigen::Vector2d(1, 2), Eigen::Vector2d::Ones()};
  const auto numbers_of = [&](const Candidate& first, const Candidate& second, const Eigen::VectorXd& x) {
    return with_numbers_of(model, {{&first, &second}, x, x}).x;
  };
  EXPECT_EQ(numbers_of(stribeck, lag, Eigen::Vector3d(7, 8, 9)), Eigen::Vector2d(8, 9));
  EXPECT_EQ(numbers_of(wide, lag, Eigen::Vector2d(5, 9)), Eigen::Vector2d(1, 9)) << "of another target";
  EXPECT_EQ(numbers_of(stribeck, lag, Eigen::Vector3d(7, 800, 9)), Eigen::Vector2d(100, 9)) << "beyond its bound";
}

TEST_F(Swap, NoPartIsInAModelTwice) {
  const std::vector<Fit> others = {of(delay, spring, Eigen::Vector3d(7, 8, 8)),
                                   of(spring, delay, Eigen::Vector3d(8, 8, 7))};
  const std::vector<Model> models = swapped(lag_and_spring, 0, others, 3);
  ASSERT_EQ(models.size(), 1u);
  EXPECT_EQ(models[0].parts, (std::vector<const Candidate*>{&delay, &spring}));
}

TEST(Alternatives, LeaveTheSameIfTheyDifferByLessThanTheNoise) {
  Fit a, b;
  a.residual = {Eigen::Vector2d(10, -10)};
  b.residual = {Eigen::Vector2d(10.9, -10.9)};
  EXPECT_TRUE(leave_the_same(a, b));
  b.residual = {Eigen::Vector2d(11.1, -11.1)};
  EXPECT_FALSE(leave_the_same(a, b));
}

// Of 196 times the noise 191 were left: beside that nothing was found either, in ten minutes.
TEST(Alternatives, BesideOneThatClosesHardlyAnythingNoSecondIsLookedFor) {
  const auto leaving = [](double error) {
    Fit fit;
    fit.residual = {Eigen::VectorXd::Constant(4, error)};
    return fit;
  };
  EXPECT_FALSE(is_worth_a_second(leaving(196), leaving(191)));
  EXPECT_TRUE(is_worth_a_second(leaving(22.6), leaving(16.6)));
}

}  // namespace
}  // namespace pvg::diagnose
