#include "host/base/counted.hpp"

#include <gtest/gtest.h>

#include "host/base/progress.hpp"

namespace pvg {
namespace {

TEST(Counted, OneIsInTheSingular) {
  EXPECT_EQ(counted(0, "episode"), "0 episodes");
  EXPECT_EQ(counted(1, "episode"), "1 episode");
  EXPECT_EQ(counted(2, "episode"), "2 episodes");
  EXPECT_EQ(counted(1, "vertex", "vertices"), "1 vertex");
  EXPECT_EQ(counted(3, "vertex", "vertices"), "3 vertices");
}

TEST(Counted, ProgressOfOneThingIsInTheSingular) {
  EXPECT_EQ(progress_line("view", "episodes", 0, 1, 0, 0), "view  0/1 episode");
  SetProgress set;
  set.total = 1;
  EXPECT_EQ(set_progress_line(set, 0), "set  0/1 episode");
}

}  // namespace
}  // namespace pvg
