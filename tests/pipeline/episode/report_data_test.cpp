// What a page of `view` shows, from an episode whose numbers are known. That the page itself works in a browser is
// shown by scripts/test_view.sh.
#include "pipeline/episode/report_data.hpp"

#include "tests/dataset/small_episode.hpp"

namespace pvg {
namespace {

std::string base64_of(const std::string& text) {
  return base64({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
}

TEST(ReportData, Base64IsThatOfTheStandard) {  // RFC 4648, section 10
  EXPECT_EQ(base64_of(""), "");
  EXPECT_EQ(base64_of("f"), "Zg==");
  EXPECT_EQ(base64_of("fo"), "Zm8=");
  EXPECT_EQ(base64_of("foo"), "Zm9v");
  EXPECT_EQ(base64_of("foobar"), "Zm9vYmFy");
}

TEST(ReportData, AnEpisodeHasItsCurvesVideosAndMotion) {
  const TestFolder root;
  const auto report = episode_report(write_small_episode(root, "episode_000002", 2), true);
  EXPECT_EQ(report["folder"], "episode_000002");
  ASSERT_EQ(report["times"].size(), 6u);
  EXPECT_EQ(report["curves"][0]["title"], "Joints");
  EXPECT_EQ(report["curves"][0]["lines"][0]["values"].dump(), "[1.0,2.0,3.0,4.0,5.0,6.0]");
  EXPECT_EQ(report["curves"][1]["lines"][1]["name"], "slide2");
  EXPECT_EQ(report["videos"][0]["name"], "wrist");
  EXPECT_TRUE(std::string(report["videos"][0]["source"]).starts_with("data:video/mp4;base64,AAAA"));
  // the moments of the pictures
  EXPECT_EQ(report["motion"]["times"].size(), 3u);
  EXPECT_NEAR(double(report["motion"]["times"][0]), 0.2, 1e-12);
}

TEST(ReportData, OfAnEpisodeThatIsOnlyInTheTableNothingHeavyIsRead) {
  const TestFolder root;
  const auto report = episode_report(write_small_episode(root, "episode_000000", 0), false);
  EXPECT_TRUE(report.contains("summary"));
  EXPECT_FALSE(report.contains("curves"));
}

}  // namespace
}  // namespace pvg
