// The command `merge`: the parts of one set become one folder, again and again; parts of different sets are refused.
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>

#include "host/base/error.hpp"
#include "pipeline/command_line/program.hpp"
#include "pipeline/episode/episode_set.hpp"
#include "tests/expect_error.hpp"
#include "tests/temporary_folder.hpp"

namespace pvg {
namespace {

namespace fs = std::filesystem;

struct Merge : testing::Test {
  TestFolder folder;
  // a part of a set: what the summary of its set says, and its episodes
  EpisodeSet part(const std::string& name, std::uint64_t seed, const std::vector<std::string>& done,
                  const std::vector<std::string>& failed) {
    for (const std::string& episode : done) {
      folder.write(name + "/" + episode + "/summary.json", "{}");
      folder.write(name + "/" + episode + "/states.h5", "states of " + episode);
      folder.write(name + "/" + episode + "/start/front.mp4", "start of " + episode);
    }
    for (const std::string& episode : failed)
      folder.write(name + "/failed/" + episode + "/summary.json", R"({"reason": "dropped"})");
    EpisodeSet set;
    set.folder = folder.path / name;
    set.task = "weigh_beaker";
    set.seed = seed;
    set.n_asked = 5;
    set.configuration = "c";
    set.versions = {{"phyvisgen", "1"}};
    fs::create_directories(set.folder);
    write_set(set);
    return set;
  }
  void merge(const std::vector<std::string>& names, bool removes = false) {
    std::vector<std::string> words = {"merge"};
    for (const std::string& name : names) words.push_back((folder.path / name).string());
    words.insert(words.end(), {"-o", (folder.path / "whole").string()});
    if (removes) words.push_back("--remove");
    run_command_line(all_commands(), words);
  }
};

// the folders of the jobs that submit writes
TEST_F(Merge, PartsMayLieInTheWhole) {
  part("whole/shards/0000", 1, {"episode_000000"}, {});
  part("whole/shards/0001", 1, {"episode_000001"}, {"episode_000003"});
  merge({"whole/shards/0000", "whole/shards/0001"}, true);
  EXPECT_EQ(read_status(folder.path / "whole").done, (std::vector<std::uint64_t>{0, 1}));
  EXPECT_TRUE(fs::exists(folder.path / "whole/failed/episode_000003/summary.json"));
  EXPECT_TRUE(fs::is_empty(folder.path / "whole/shards"));
}

TEST_F(Merge, PartsBecomeOneSetAndASecondCallChangesNothing) {
  part("a", 1, {"episode_000000", "episode_000002"}, {"episode_000004"});
  part("b", 1, {"episode_000001", "episode_000002"}, {});
  for (int i = 0; i < 2; ++i) {
    merge({"a", "b"});
    const EpisodeSet whole = read_set(folder.path / "whole");
    const SetStatus status = read_status(whole.folder);
    EXPECT_EQ(status.done, (std::vector<std::uint64_t>{0, 1, 2}));
    ASSERT_EQ(status.failed.size(), 1u);
    EXPECT_EQ(status.failed[0].episode, 4u);
    EXPECT_EQ(missing(whole, status), std::vector<std::uint64_t>{3});
    EXPECT_DOUBLE_EQ(success_rate(status), 0.75);
    std::ifstream states(whole.folder / "episode_000001/states.h5");
    EXPECT_EQ(std::string(std::istreambuf_iterator<char>(states), {}), "states of episode_000001");
    std::ifstream start(whole.folder / "episode_000001/start/front.mp4");
    EXPECT_EQ(std::string(std::istreambuf_iterator<char>(start), {}), "start of episode_000001");
  }
  EXPECT_TRUE(fs::exists(folder.path / "a/episode_000000"));
}

TEST_F(Merge, TheFolderOfTheWholeMayBeAPartAndPartsMayGo) {
  part("whole", 1, {"episode_000000"}, {});
  part("b", 1, {"episode_000001"}, {});
  merge({"whole", "b"}, true);
  EXPECT_EQ(read_status(folder.path / "whole").done, (std::vector<std::uint64_t>{0, 1}));
  EXPECT_FALSE(fs::exists(folder.path / "b"));
}

TEST_F(Merge, PartsOfDifferentSetsAreRefusedBeforeAnythingIsWritten) {
  part("a", 1, {"episode_000000"}, {});
  part("b", 2, {"episode_000001"}, {});
  EpisodeSet c = part("c", 1, {}, {}), d = part("d", 1, {}, {}), e = part("e", 1, {}, {});
  c.task = "fold_towel";
  d.versions = {{"phyvisgen", "2"}};
  e.configuration = "other";
  for (const EpisodeSet& set : {c, d, e}) write_set(set);
  expect_error<UsageError>([&] { merge({"a", "b"}); }, {"/a", "/b", "seeds (2 and 1)"});
  expect_error<UsageError>([&] { merge({"a", "c"}); }, {"/c", "tasks (fold_towel and weigh_beaker)"});
  expect_error<UsageError>([&] { merge({"a", "d"}); }, {"/d", "versions (phyvisgen 2)"});
  expect_error<UsageError>([&] { merge({"a", "e"}); }, {"/e", "configurations"});
  expect_error<UsageError>([&] { merge({"a", "nowhere"}); }, {"nowhere/set.json"});
  EXPECT_FALSE(fs::exists(folder.path / "whole"));
}

TEST_F(Merge, AnEpisodeThatDiffersInTwoPartsIsNamed) {
  part("a", 1, {"episode_000003"}, {});
  part("b", 1, {"episode_000003"}, {});
  folder.write("b/episode_000003/states.h5", "other states, as long");
  expect_error<Failure>([&] { merge({"a", "b"}); }, {"episode 3", "/b"});
}

}  // namespace
}  // namespace pvg
