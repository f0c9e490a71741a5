// The page of a diagnosis: what its plots and its table of alternatives say of noise and uncertainty.
#include <gtest/gtest.h>

#include <cmath>

#include "host/identify/report/report.hpp"

namespace pvg::diagnose {
namespace {

struct ReportPage : testing::Test {
  Problem problem;
  Diagnosis diagnosis;
  Candidate friction;
  void SetUp() override {
    // from 0.03 to 7.7 s, residuals below the noise of 0.5
    diagnosis.curves = {{"run_00", "angle", "rad", true, {0.03, 7.7}, {1, 1}, {0.9, 1.2}, {1, 1}, 0.5}};
    friction.name = "joint_coulomb_friction";
    friction.parameters = {{"effort", "N m"}, {"width", "rad/s"}};
    RankedModel model;
    model.parts = {&friction};
    model.values = {0.18, 0.002};
    model.deviations = {0.0123, NAN};
    diagnosis.ranking = {model};
  }
  void expect(const std::string& part) {
    const std::string page = html_of(problem, diagnosis);
    EXPECT_NE(page.find(part), std::string::npos) << part;
  }
};

TEST_F(ReportPage, TicksAreRoundNumbersWithinTheAxes) {
  for (const char* seconds : {">2</text>", ">4</text>", ">6</text>"}) expect(seconds);
  EXPECT_EQ(html_of(problem, diagnosis).find(">0.03</text>"), std::string::npos);
  expect(">-0.4</text>");  // the axis of residuals holds the noise
}

// such as where the time was over: zeros would look like a measurement
TEST_F(ReportPage, WhatWasNotJudgedHasNoNumbers) {
  diagnosis.floor = 0;
  diagnosis.ranking.clear();
  expect("There is no held-out error.");
  expect("No effect was compared to its end.");
  EXPECT_EQ(html_of(problem, diagnosis).find("Held-out error 0"), std::string::npos);
}

TEST_F(ReportPage, TheNoiseIsABandBehindTheResiduals) {
  // once: not behind the curves themselves
  const std::string page = html_of(problem, diagnosis), band = "class='noise'/>";
  ASSERT_NE(page.find(band), std::string::npos);
  EXPECT_EQ(page.find(band), page.rfind(band));
}

TEST_F(ReportPage, AlternativesHaveStandardDeviationsWhereTheyAreKnown) {
  expect("effort 0.18 ± 0.0123 N m, width 0.002 rad/s");
}

}  // namespace
}  // namespace pvg::diagnose
