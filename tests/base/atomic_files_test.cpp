// Folders appear complete or not at all; what a killed run left behind goes, what another run is writing stays.
#include "host/base/atomic_files.hpp"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fstream>
#include <iterator>

#include "host/base/error.hpp"

namespace pvg {
namespace {

namespace fs = std::filesystem;

struct AtomicFiles : testing::Test {
  AtomicFiles() { fs::create_directories(root); }
  ~AtomicFiles() override { fs::remove_all(root); }
  fs::path root = fs::temp_directory_path() / ("pvg_atomic_" + std::to_string(getpid()));
};

void write(const fs::path& path, const std::string& text) { std::ofstream(path) << text; }
std::string text_of(const fs::path& path) {
  std::ifstream in(path);
  return {std::istreambuf_iterator<char>(in), {}};
}
std::size_t n_entries(const fs::path& folder) {
  return std::size_t(std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
}

TEST_F(AtomicFiles, AFolderAppearsOnlyWhenItIsFinished) {
  {
    PartialFolder folder(root / "episode_000000");
    write(folder.path() / "a", "1");
    EXPECT_FALSE(fs::exists(root / "episode_000000"));
    folder.finish();
    EXPECT_TRUE(fs::exists(root / "episode_000000" / "a"));
  }
  EXPECT_TRUE(fs::exists(root / "episode_000000" / "a"));
  {
    PartialFolder folder(root / "episode_000001");
    write(folder.path() / "a", "1");
  }
  EXPECT_EQ(n_entries(root), 1u);
}

TEST_F(AtomicFiles, AFinishedFolderReplacesTheOldOne) {
  fs::create_directory(root / "episode_000000");
  write(root / "episode_000000" / "old", "1");
  PartialFolder folder(root / "episode_000000");
  write(folder.path() / "new", "1");
  folder.finish();
  EXPECT_FALSE(fs::exists(root / "episode_000000" / "old"));
  EXPECT_TRUE(fs::exists(root / "episode_000000" / "new"));
}

TEST_F(AtomicFiles, LeftoversOfEndedProcessesGoAndThoseOfLiveOnesAndOfOtherMachinesStay) {
  const pid_t child = fork();
  if (child == 0) _exit(0);
  waitpid(child, nullptr, 0);
  char host[256] = "";
  gethostname(host, sizeof host - 1);
  const std::string gone = std::to_string(child), alive = std::to_string(getppid());
  fs::create_directory(root / (".episode_000000.partial-" + gone + "." + host));
  fs::create_directory(root / (".episode_000001.partial-" + alive + "." + host));
  fs::create_directory(root / (".episode_000003.partial-" + gone + ".elsewhere-" + host));
  fs::create_directory(root / "episode_000002");
  fs::create_directory(root / ".mine.partial-x");
  EXPECT_EQ(remove_leftovers(root), 1u);
  EXPECT_EQ(n_entries(root), 4u);
  EXPECT_FALSE(fs::exists(root / (".episode_000000.partial-" + gone + "." + host)));
}

TEST_F(AtomicFiles, WhatIsInTheMakingCanBeRemovedFromOutside) {
  fs::create_directory(root / "episode_000001");
  PartialFolder folder(root / "episode_000000");
  fs::create_directory(folder.path() / "inner");
  write(folder.path() / "inner" / "a", "1");
  remove_unfinished_folders();
  EXPECT_FALSE(fs::exists(folder.path()));
  EXPECT_TRUE(fs::exists(root / "episode_000001"));
}

TEST_F(AtomicFiles, TextIsReplacedWholeAndNothingElseIsLeft) {
  write_text_atomically(root / "set.json", "{}");
  write_text_atomically(root / "set.json", "{\"done\": 1}");
  EXPECT_EQ(text_of(root / "set.json"), "{\"done\": 1}");
  EXPECT_EQ(n_entries(root), 1u);
  EXPECT_THROW(write_text_atomically("/no/such/folder/set.json", ""), Failure);
}

TEST_F(AtomicFiles, AFolderThatCannotBeMadeIsAUsageErrorThatNamesIt) {
  write(root / "file", "");
  try {
    make_writable_folder(root / "file" / "out");
    FAIL() << "nothing was thrown";
  } catch (const UsageError& error) {
    EXPECT_NE(std::string(error.what()).find((root / "file" / "out").string()), std::string::npos);
  }
  make_writable_folder(root / "a" / "b");
  EXPECT_EQ(n_entries(root / "a" / "b"), 0u);
}

}  // namespace
}  // namespace pvg
