// The table of constants that decide a diagnosis
#include "host/identify/criteria.hpp"

#include <gtest/gtest.h>

#include <set>

#include "host/base/error.hpp"
#include "tests/expect_error.hpp"

namespace pvg::diagnose {
namespace {

TEST(Criteria, EachHasANameOfItsOwnAStageAMeaningAndItsEvidence) {
  std::set<std::string> names;
  for (const Criterion& one : list_criteria()) {
    EXPECT_TRUE(names.insert(one.name).second) << one.name;
    EXPECT_GE(one.stage, 1) << one.name;
    EXPECT_LE(one.stage, 7) << one.name;
    EXPECT_FALSE(one.unit.empty() || one.meaning.empty() || one.evidence.empty()) << one.name;
    EXPECT_EQ(one.value, one.usual) << one.name;
  }
  EXPECT_GT(names.size(), 90u);
}

TEST(Criteria, OneThatIsSetIsReadByAll) {
  set_criterion("unexplained=1.8");
  set_criterion("n_finalists", 5.6);
  EXPECT_EQ(criteria().unexplained, 1.8);
  EXPECT_EQ(criteria().n_finalists, 6u);
  reset_criteria();
  EXPECT_EQ(criteria().unexplained, 1.5);
}

TEST(Criteria, ASeriesKeepsItsRatios) {
  const Series usual = criteria().window_lengths;
  set_criterion("window_lengths=3");
  ASSERT_EQ(criteria().window_lengths.size(), usual.size());
  for (std::size_t i = 0; i < usual.size(); ++i) EXPECT_DOUBLE_EQ(criteria().window_lengths[i], 1.5 * usual[i]);
  reset_criteria();
  EXPECT_EQ(criteria().window_lengths, usual);
}

TEST(Criteria, ANameThatIsNoneListsSimilarOnes) {
  expect_error<UsageError>([] { set_criterion("agrees_rmss=1"); }, {"agrees_rms", "agrees_sigma"});
  expect_error<UsageError>([] { set_criterion("agrees_rms"); }, {"NAME=VALUE"});
  expect_error<UsageError>([] { set_criterion("agrees_rms=big"); }, {"NAME=VALUE"});
}

}  // namespace
}  // namespace pvg::diagnose
