#include "host/identify/search/decide.hpp"

#include <gtest/gtest.h>

#include "host/identify/search/prove.hpp"

#include <cmath>
#include <random>

namespace pvg::diagnose {
namespace {

using Eigen::VectorXd;

constexpr int N = 2000;  // samples of one channel in one window

FitData one_window() {
  FitData data{{Window{}}, {Eigen::MatrixXd(N, 0)}};
  for (std::size_t i = 0; i < N; ++i) data.windows[0].data.push_back({0, i, 0});
  return data;
}

// Normal numbers, each `repeated` times, of unit mean square.
VectorXd noise(int repeated) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  VectorXd values(N);
  for (int i = 0; i < N; ++i) values[i] = i % repeated == 0 ? normal(random) : values[i - 1];
  return values / std::sqrt(values.squaredNorm() / N);
}

// +1, -1, ...: no part of noise that is repeated an even number of times
VectorXd alternating() {
  VectorXd values(N);
  for (int i = 0; i < N; ++i) values[i] = i % 2 ? -1 : 1;
  return values;
}

Candidate candidate(const std::string& name, double log_prior) {
  Candidate made;
  made.name = name;
  made.family = Family::parameter;
  made.parameters = {{"size", "1", 0, 10, 0}};
  made.log_prior = log_prior;
  return made;
}

Fit fit_of(const Candidate* part, double x, double sigma, const VectorXd& residual) {
  Fit fit;
  if (part != nullptr) fit.model = {{part}, VectorXd::Constant(1, x), VectorXd::Ones(1)};
  fit.residual = {residual};
  fit.covariance = Eigen::MatrixXd::Constant(1, 1, sigma * sigma);
  fit.slope = {Eigen::MatrixXd::Zero(N, fit.model.x.size())};
  fit.of_start = {Eigen::MatrixXd(N, 0)};
  fit.delta = {VectorXd(0)};
  fit.scale = rms(fit.residual);
  fit.succeeded = true;
  return fit;
}

// noise of 1 and what a model leaves besides, so that the root of the mean square is `error`
VectorXd residual_of(double error) { return noise(2) + std::sqrt(error * error - 1) * alternating(); }

TEST(Decide, OfEquallyGoodModelsTheLikelierOneIsNamedAndTheOtherBesideIt) {
  const Candidate rare = candidate("rare", -3), common = candidate("common", 0);
  const std::vector<Fit> fits{fit_of(&rare, 5, 0.1, residual_of(1)), fit_of(&common, 5, 0.1, residual_of(1))};
  const Decision decision = decide(one_window(), fit_of(nullptr, 0, 0, residual_of(6)), fits);
  ASSERT_GE(decision.chosen, 0);
  EXPECT_EQ(decision.ranking[std::size_t(decision.chosen)].fit->model.parts[0]->name, "common");
  EXPECT_EQ(decision.inseparable.size(), 2u);
  EXPECT_NEAR(decision.base_error, 6, 1e-9);
}

TEST(Decide, NothingIsNamedWhereItsSizeIsNotMeasured) {
  const Candidate some = candidate("some", 0);
  const Fit base = fit_of(nullptr, 0, 0, residual_of(6));
  EXPECT_EQ(decide(one_window(), base, {fit_of(&some, 5, 0.1, residual_of(1))}).chosen, 0);
  EXPECT_EQ(decide(one_window(), base, {fit_of(&some, 5, 2.6, residual_of(1))}).chosen, -1) << "may be off";
  EXPECT_EQ(decide(one_window(), base, {fit_of(&some, 10, 0.1, residual_of(1))}).chosen, -1) << "at a bound";
  EXPECT_EQ(decide(one_window(), base, {fit_of(&some, 5, 0.1, residual_of(6))}).chosen, -1) << "closes nothing";
}

// Another model explains as much at its bound. What is named only because that bound ends there, say adhesion of a
// block whose friction is more than five times what its scene says, was not measured either.
TEST(Decide, ANameIsDoubtedWhereAMoreProbableModelEndsAtItsBound) {
  const Candidate rare = candidate("rare", -3), common = candidate("common", 0);
  const Fit base = fit_of(nullptr, 0, 0, residual_of(6)), named = fit_of(&rare, 5, 0.1, residual_of(1));
  const auto doubt_by = [&](const Fit& other) {
    const std::vector<Fit> fits{named, other};
    const Decision decision = decide(one_window(), base, fits);
    EXPECT_EQ(decision.ranking[std::size_t(decision.chosen)].fit->model.parts[0]->name, "rare");
    return decision.better_at_bound;
  };
  const std::vector<Fit> fits{named, fit_of(&common, 10, 0.1, residual_of(1))};
  const Decision doubted = decide(one_window(), base, fits);
  ASSERT_GE(doubted.better_at_bound, 0);
  EXPECT_EQ(doubted.ranking[std::size_t(doubted.better_at_bound)].fit, &fits[1]);
  EXPECT_EQ(doubt_by(fit_of(&common, 10, 0.1, residual_of(2))), -1) << "it explains less";
  EXPECT_EQ(doubt_by(fit_of(&common, 10, 6, residual_of(1))), -1) << "it may be off";
  const Candidate rarer = candidate("rarer", -6);
  EXPECT_EQ(doubt_by(fit_of(&rarer, 10, 0.1, residual_of(1))), -1) << "it is less probable";
}

// residuals that are cut do not feel the noise, so a run that is missed by far is no reason to doubt a model that fits
// it
TEST(Decide, ARunThatIsMissedByFarDoesNotHideWhatExplainsIt) {
  const Candidate some = candidate("some", 0);
  FitData data;
  Fit base = fit_of(nullptr, 0, 0, residual_of(1)), fit = fit_of(&some, 5, 0.1, residual_of(1));
  for (int run = 0; run < 3; ++run) {
    data.windows.push_back(one_window().windows[0]);
    data.windows.back().run = run;
    data.of_start.push_back(Eigen::MatrixXd(N, 0));
  }
  base.residual = {residual_of(1), residual_of(400), residual_of(1)};
  base.slope.assign(3, Eigen::MatrixXd(N, 0));
  fit.residual.assign(3, residual_of(1));
  fit.slope.assign(3, Eigen::MatrixXd::Zero(N, 1));
  base.of_start = fit.of_start = data.of_start;
  base.delta = fit.delta = {VectorXd(0), VectorXd(0), VectorXd(0)};
  base.scale = robust_scale(base.residual);
  EXPECT_EQ(decide(data, base, {fit}).chosen, 0);
}

// One run of three is a hundred times as sensitive as the others. Noise of theirs, 0.1 per sample along what the effect
// does, says that there is none where that run is left out.
TEST(Decide, AnEffectThatOneRunAloneShowsIsNamed) {
  const Candidate some = candidate("some", 0);
  FitData data;
  Fit base = fit_of(nullptr, 0, 0, residual_of(1)), fit = fit_of(&some, 5, 0.1, residual_of(1));
  base.residual.clear(), fit.residual.clear(), base.slope.clear(), fit.slope.clear();
  const double size[] = {0.01, 0.01, 1}, left[] = {0.1, 0.1, -0.002};  // the sum of their products is 0
  for (int run = 0; run < 3; ++run) {
    data.windows.push_back(one_window().windows[0]);
    data.windows.back().run = run;
    data.of_start.push_back(Eigen::MatrixXd(N, 0));
    fit.residual.push_back(noise(2) + left[run] * alternating());
    fit.slope.push_back(size[run] * alternating());
    base.residual.push_back(fit.residual.back() - 5 * size[run] * alternating());
    base.slope.push_back(Eigen::MatrixXd(N, 0));
  }
  base.of_start = fit.of_start = data.of_start;
  base.delta = fit.delta = {VectorXd(0), VectorXd(0), VectorXd(0)};
  const std::vector<Fit> fits{fit};
  const Decision decision = decide(data, base, fits);
  EXPECT_EQ(decision.chosen, 0);
  EXPECT_NEAR(decision.ranking.at(0).error, 1, 0.02);
  set_criterion("left_out_ridge", 1e-6);
  EXPECT_EQ(decide(data, base, fits).chosen, -1);
  reset_criteria();
}

TEST(NamedParameter, OfALogarithmHasItsIntervalThere) {
  Parameter speed{"velocity", "rad/s", 1e-3, 10, 0.1};
  const NamedParameter linear = named_parameter(speed, 0.02, 0.04);
  EXPECT_DOUBLE_EQ(linear.low, 1e-3);  // its bound
  EXPECT_DOUBLE_EQ(linear.high, 0.1);
  speed.is_logarithmic = true;
  const NamedParameter found = named_parameter(speed, 0.02, 0.02);
  EXPECT_DOUBLE_EQ(found.low, 0.02 * std::exp(-2));
  EXPECT_DOUBLE_EQ(found.high, 0.02 * std::exp(2));
}

TEST(Decide, TheSimplerModelIsNamedUnlessItsLogPriorIsLow) {
  const auto named = [&](double prior_of_simple) {
    const Candidate simple = candidate("simple", prior_of_simple);
    Candidate richer = candidate("richer", 0);
    richer.parameters.push_back({"shape", "1", 0, 10, 0});
    Fit rich = fit_of(nullptr, 0, 0, residual_of(1));
    rich.model = {{&richer}, VectorXd::Constant(2, 5), VectorXd::Ones(2)};
    rich.slope = {Eigen::MatrixXd::Zero(N, 2)};
    rich.covariance = 0.01 * Eigen::MatrixXd::Identity(2, 2);
    const std::vector<Fit> fits{fit_of(&simple, 5, 0.1, residual_of(1)), rich};
    const Decision decision = decide(one_window(), fit_of(nullptr, 0, 0, residual_of(6)), fits);
    return decision.ranking.at(std::size_t(decision.chosen)).fit->model.parts[0]->name;
  };
  EXPECT_EQ(named(-2), "simple");
  EXPECT_EQ(named(-10), "richer");
}

TEST(Decide, TheLogPriorComesFirstOnlyWhereTheBestLeavesMuch) {
  const Candidate skilled = candidate("skilled", -4), likely = candidate("likely", 0);
  const Fit base = fit_of(nullptr, 0, 0, residual_of(6));
  const auto named = [&](double by_skilled, double by_likely) {
    const std::vector<Fit> fits{fit_of(&skilled, 5, 0.1, residual_of(by_skilled)),
                                fit_of(&likely, 5, 0.1, residual_of(by_likely))};
    const Decision decision = decide(one_window(), base, fits);
    return decision.ranking.at(std::size_t(decision.chosen)).fit->model.parts[0]->name;
  };
  EXPECT_EQ(named(2.0, 2.4), "likely");
  EXPECT_EQ(named(1.0, 2.4), "skilled") << "reaches the noise";
  EXPECT_EQ(named(2.0, 4.0), "skilled") << "the other closes half of what it closes";
}

TEST(Decide, SamplesThatHangTogetherCountAsOne) {
  // by hand: the mean square falls by 0.25; its standard error is 2 sqrt(c 0.25 / n) with c samples saying the same:
  // 0.022 for white noise, 0.16 for c = 50
  const Candidate some = candidate("some", 0);
  for (const auto& [repeated, chosen] : {std::pair(1, 0), std::pair(50, -1)}) {
    const Fit base = fit_of(nullptr, 0, 0, noise(repeated) + 0.5 * alternating());
    const Decision decision = decide(one_window(), base, {fit_of(&some, 5, 0.1, noise(repeated))});
    EXPECT_EQ(decision.chosen, chosen);
    EXPECT_NEAR(decision.ranking[0].better_sigma, repeated == 1 ? 0.0224 : 0.158, repeated == 1 ? 0.003 : 0.04);
  }
}

TEST(Decide, AnEffectThatShowsInOneOfThreeRunsIsNamedUnlessTheOthersGetWorse) {
  const Candidate some = candidate("some", 0);
  FitData data;
  for (int run = 0; run < 3; ++run) {
    data.windows.push_back(one_window().windows[0]);
    data.windows.back().run = run;
    data.of_start.push_back(Eigen::MatrixXd(N, 0));
  }
  const auto fit_with = [&](const Candidate* part, std::vector<double> errors) {
    Fit fit = fit_of(part, 5, 0.1, residual_of(errors[0]));
    for (const double error : {errors[1], errors[2]}) {
      fit.residual.push_back(residual_of(error));
      fit.slope.push_back(fit.slope[0]);
      fit.of_start.push_back(fit.of_start[0]);
      fit.delta.push_back(VectorXd(0));
    }
    return fit;
  };
  const Fit base = fit_with(nullptr, {3, 1, 1});
  EXPECT_EQ(decide(data, base, {fit_with(&some, {1, 1, 1})}).chosen, 0);
  EXPECT_EQ(decide(data, base, {fit_with(&some, {1, 2, 2})}).chosen, -1);
}

// of a gap of 86.5
TEST(Proof, TwoEffectsOfWhichTheFirstClosesLittleHaveToExplainTheHeldOutRunsToTheNoise) {
  HeldOut held_out;
  held_out.before = 88, held_out.floor = 1.5;
  const auto close_enough = [&](std::vector<double> after_each, double sigma = INFINITY) {
    held_out.after_each = std::move(after_each);
    held_out.after = held_out.after_each.back();
    held_out.kept = held_out.after_each.size();
    held_out.lead.assign(held_out.kept, {});
    held_out.lead.back().sigma = sigma;
    return closes_enough(held_out);
  };
  EXPECT_TRUE(close_enough({33}));  // 64 %
  EXPECT_FALSE(close_enough({80, 33}, 9));
  EXPECT_TRUE(close_enough({80, 2.2}));  // below 1.5 times the noise
  EXPECT_TRUE(close_enough({35, 33}));
}

TEST(Proof, OrToCloseAsMuchAsTwoThatAreEachEnoughAndToBeAheadOfEveryOtherPair) {
  EXPECT_DOUBLE_EQ(share_of_effects(0.6, 1), 0.6);
  EXPECT_DOUBLE_EQ(share_of_effects(0.6, 2), 0.84);
  HeldOut held_out;
  held_out.before = 11, held_out.floor = 1, held_out.kept = 2;
  const auto close_enough = [&](double after, double sigma) {
    held_out.after = after;
    held_out.after_each = {7, after};  // the first closes 40 %
    held_out.lead = {{}, {sigma, "friction and play"}};
    return closes_enough(held_out);
  };
  EXPECT_TRUE(close_enough(2.5, 2.1));
  EXPECT_FALSE(close_enough(2.7, 2.1));  // 83 %
  EXPECT_FALSE(close_enough(2.5, 1.9));
  EXPECT_FALSE(close_enough(2.5, NAN));  // no time for the others
  held_out.kept = 3;                     // a third effect need not close 60 % of the rest
  held_out.after = 2.2;
  held_out.after_each = {7, 2.5, 2.2};
  held_out.lead = {{}, {2.1, ""}, {1, ""}};
  EXPECT_TRUE(closes_enough(held_out));
}

// |a|^2 = 8 in four numbers, |b|^2 = 12, |b - a|^2 = 12
TEST(Proof, OneModelIsAheadOfAnotherInStandardDeviationsOfWhatItLeaves) {
  const std::vector<VectorXd> a = {Eigen::Vector2d(2, 0), Eigen::Vector2d(0, 2)};
  const std::vector<VectorXd> b = {Eigen::Vector2d(0, 2), Eigen::Vector2d(2, 2)};
  EXPECT_NEAR(ahead_of(a, b, 1), 4 / (2 * std::sqrt(2.0) * std::sqrt(12.0)), 1e-12);
  EXPECT_NEAR(ahead_of(a, b, 4), ahead_of(a, b, 1) / 2, 1e-12);
  EXPECT_EQ(ahead_of(a, a, 1), 0);
  EXPECT_LT(ahead_of(b, a, 1), 0);
}

TEST(Decide, TheLowestTrainingErrorNamesWhateverIsLower) {
  const Candidate a = candidate("a", 0), b = candidate("b", 0);
  const std::vector<Fit> fits{fit_of(&a, 5, 100, residual_of(1.999)), fit_of(&b, 10, 100, residual_of(1.998))};
  const Decision decision = decide_lowest(fit_of(nullptr, 0, 0, residual_of(2)), fits);
  ASSERT_EQ(decision.chosen, 0);
  EXPECT_EQ(decision.ranking[0].fit->model.parts[0]->name, "b");
}

}  // namespace
}  // namespace pvg::diagnose
