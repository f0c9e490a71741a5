// What a user reads while a set is made: numbers by hand.
#include "host/base/progress.hpp"

#include <gtest/gtest.h>

namespace pvg {
namespace {

TEST(Progress, AnEpisodeShowsItsRateAndWhatIsLeft) {
  EXPECT_EQ(progress_line("episode 7", "frames", 0, 40, 3, 8), "episode 7  [--------]  0/40 frames");
  // 12 in 4 s are 3 a second; 28 more take 9.3 s
  EXPECT_EQ(progress_line("episode 7", "frames", 12, 40, 4, 8),
            "episode 7  [##------]  12/40 frames  3.00 frames/s  9 s left");
  // what takes longer than 10 s each is counted per minute: 3 in 30 s, 2 in 24 s and in 7321 s
  EXPECT_EQ(progress_line("view", "episodes", 3, 3, 30, 0), "view  3/3 episodes  0.10 episodes/s  in 30 s");
  EXPECT_EQ(progress_line("view", "episodes", 2, 2, 24, 0), "view  2/2 episodes  5.00 episodes/min  in 24 s");
  EXPECT_EQ(progress_line("view", "episodes", 2, 2, 7321, 0), "view  2/2 episodes  0.02 episodes/min  in 2 h 02 min");
}

TEST(Progress, ASetShowsItsSuccessItsRateAndWhatIsLeft) {
  SetProgress set;
  set.total = 20;
  EXPECT_EQ(set_progress_line(set, 0), "set  0/20 episodes");
  set.done_before = 4;
  EXPECT_EQ(set_progress_line(set, 4), "set  [----]  4/20 episodes  100 % succeeded");
  // 9 of 10 succeeded; this run made 6 in 90 s, 4 a minute: 10 more take 150 s
  set.done = 5, set.failed = 1, set.seconds = 90;
  EXPECT_EQ(set_progress_line(set, 4), "set  [##--]  10/20 episodes  90 % succeeded  4.00/min  2 min 30 s left");
  set.done = 15, set.seconds = 60;
  EXPECT_EQ(set_progress_line(set, 0), "set  20/20 episodes  95 % succeeded  16/min  in 1 min 00 s");
}

TEST(Progress, ALineFitsTheTerminalWhateverItsWidth) {
  const auto line = [](int bar) { return progress_line("episode 7", "frames", 12, 40, 4, bar); };
  for (int width = 0; width <= 200; ++width) EXPECT_LE(int(fitted_line(line, width).size()), width);
  // an eighth of the width, at most 24; 56: the least of 6; 50: none; 20: cut
  EXPECT_EQ(fitted_line(line, 400), line(24));
  EXPECT_EQ(fitted_line(line, 80), line(10));
  EXPECT_EQ(fitted_line(line, int(line(0).size()) + 4 + 6), line(6));
  EXPECT_EQ(fitted_line(line, int(line(0).size()) + 4 + 5), line(0));
  EXPECT_EQ(fitted_line(line, 20), line(0).substr(0, 20));
}

TEST(Progress, BarsOfASetAndItsEpisodeAreAlikeIn80Columns) {
  SetProgress set;
  set.total = 100, set.done = 12, set.seconds = 12 * 47;  // "1.28/min  1 h 08 min left"
  const auto above = [&](int bar) { return set_progress_line(set, bar); };
  const auto line = [](int bar) { return progress_line("episode 12", "frames", 120, 140, 4, bar); };
  EXPECT_EQ(fitted_line(above, 79), above(9));
  EXPECT_EQ(fitted_line(line, 79), line(9));
}

}  // namespace
}  // namespace pvg
