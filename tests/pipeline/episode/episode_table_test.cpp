// The table of the main job: it passes its own check, and docs/theory/pipeline.md shows it as it is.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>

#include "pipeline/episode/episode.hpp"
#include "pipeline/episode/motion_plan.hpp"

namespace pvg {
namespace {

TEST(EpisodeTable, PassesTheCheck) { EXPECT_NO_THROW(check(episode_table())); }

TEST(EpisodeTable, ThePipelinePageShowsItAsItIs) {
  std::ifstream in(std::filesystem::path(PVG_DATA_FOLDER).parent_path() / "docs/theory/pipeline.md");
  const std::string page{std::istreambuf_iterator<char>(in), {}};
  EXPECT_NE(page.find("```mermaid\n" + draw(episode_table()) + "```"), std::string::npos)
      << "put the output of `phyvisgen generate --graph` into docs/theory/pipeline.md";
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
