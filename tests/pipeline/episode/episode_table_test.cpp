// The table of the main job: it passes its own check, and the README shows it as it is.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>

#include "pipeline/episode/episode.hpp"
#include "pipeline/episode/motion_plan.hpp"

namespace pvg {
namespace {

TEST(EpisodeTable, PassesTheCheck) { EXPECT_NO_THROW(check(episode_table())); }

TEST(EpisodeTable, TheReadmeShowsItAsItIs) {
  std::ifstream in(std::filesystem::path(PVG_DATA_FOLDER).parent_path() / "README.md");
  const std::string readme{std::istreambuf_iterator<char>(in), {}};
  EXPECT_NE(readme.find("```mermaid\n" + draw(episode_table()) + "```"), std::string::npos)
      << "put the output of `phyvisgen generate --graph` into README.md";
}

TEST(StepsPerFrame, FramesFallOnSteps) {
  EXPECT_EQ(steps_per_frame(10, 0.02), 5u);
  EXPECT_EQ(steps_per_frame(50, 0.02), 1u);
  EXPECT_EQ(steps_per_frame(25, 0.01), 4u);
  EXPECT_THROW(steps_per_frame(30, 0.02), UsageError);
  EXPECT_THROW(steps_per_frame(100, 0.02), UsageError);
}

}  // namespace
}  // namespace pvg
