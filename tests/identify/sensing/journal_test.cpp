#include "host/identify/sensing/journal.hpp"

#include <gtest/gtest.h>

#include "tests/temporary_folder.hpp"

namespace pvg::diagnose {
namespace {

std::vector<Prediction> answer(double value, const std::string& pair) {
  Prediction p;
  p.residual = Eigen::VectorXd::LinSpaced(5, 0, value);
  p.phase = {Phase::slide, Phase::rest};
  p.touching = {pair};
  return {p, Prediction{}};
}

void write_two(const std::filesystem::path& file, std::uint64_t key) {
  Journal journal(file, key);
  journal.add(11, answer(1.0 / 3, "floor/block"));
  journal.add(12, answer(2, ""));
}

TEST(Journal, WhatWasAskedBeforeIsAnsweredToTheBit) {
  const TestFolder folder;
  const std::filesystem::path file = folder.path / "simulated.bin";
  write_two(file, 7);
  Journal again(file, 7);
  const auto first = again.answer_to(11);
  ASSERT_TRUE(first);
  ASSERT_EQ(first->size(), 2u);
  EXPECT_EQ((*first)[0].residual, Eigen::VectorXd::LinSpaced(5, 0, 1.0 / 3));
  EXPECT_EQ((*first)[0].phase, (std::vector<Phase>{Phase::slide, Phase::rest}));
  EXPECT_EQ((*first)[0].touching, std::vector<std::string>{"floor/block"});
  EXPECT_EQ((*first)[1].residual.size(), 0);
  EXPECT_TRUE(again.answer_to(12));
  EXPECT_FALSE(again.answer_to(13));
  again.add(13, answer(3, "x"));
  Journal third(file, 7);
  for (const std::uint64_t question : {11, 12, 13}) EXPECT_TRUE(third.answer_to(question)) << question;
}

TEST(Journal, AnotherKeyOrAnotherQuestionVoidsWhatFollows) {
  const TestFolder folder;
  const std::filesystem::path file = folder.path / "simulated.bin";
  write_two(file, 7);
  Journal other(file, 8);
  EXPECT_FALSE(other.answer_to(11));
  write_two(file, 7);
  Journal strays(file, 7);
  EXPECT_TRUE(strays.answer_to(11));
  EXPECT_FALSE(strays.answer_to(99));
  strays.add(99, answer(1, "y"));
  Journal after(file, 7);
  EXPECT_TRUE(after.answer_to(11));
  EXPECT_TRUE(after.answer_to(99));
  EXPECT_FALSE(after.answer_to(12));
}

TEST(Journal, AnAnswerThatWasCutShortIsForgotten) {
  const TestFolder folder;
  const std::filesystem::path file = folder.path / "simulated.bin";
  write_two(file, 7);
  std::filesystem::resize_file(file, std::filesystem::file_size(file) - 3);
  Journal journal(file, 7);
  EXPECT_TRUE(journal.answer_to(11));
  EXPECT_FALSE(journal.answer_to(12));
}

}  // namespace
}  // namespace pvg::diagnose
