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

// as in two containers that share a host name, where each process has the number 1
TEST_F(AtomicFiles, TwoOfOneNumberDoNotMeetAndALockKeepsWhatIsInTheMaking) {
  PartialFolder first(root / "episode_000000"), second(root / "episode_000000");
  EXPECT_NE(first.path(), second.path());
  EXPECT_EQ(remove_leftovers(root), 0u);
  EXPECT_TRUE(fs::exists(first.path()));
  first.finish();
  second.finish();
  EXPECT_EQ(n_entries(root), 1u);
}

TEST_F(AtomicFiles, AFolderWithoutItsLockIsALeftoverThoughAProcessOfItsNumberLives) {
  char host[256] = "";
  gethostname(host, sizeof host - 1);
  const fs::path left =
      root / (".episode_000000.partial-" + std::to_string(getpid()) + "." + host + ".0123456789abcdef");
  fs::create_directory(left);
  EXPECT_EQ(remove_leftovers(root), 1u);
  EXPECT_FALSE(fs::exists(left));
}

TEST_F(AtomicFiles, AFileAppearsOnlyWhenItIsFinished) {
  {
    PartialFile file(root / "a.h5");
    write(file.path(), "1");
    EXPECT_EQ(file.path().extension(), ".h5");
  }
  EXPECT_EQ(n_entries(root), 0u);
  PartialFile file(root / "a.h5");
  write(file.path(), "1");
  file.finish();
  EXPECT_EQ(text_of(root / "a.h5"), "1");
}

TEST_F(AtomicFiles, WhatIsInTheMakingCanBeRemovedFromOutside) {
  fs::create_directory(root / "episode_000001");
  PartialFolder folder(root / "episode_000000");
  fs::create_directory(folder.path() / "inner");
  write(folder.path() / "inner" / "a", "1");
  remove_unfinished();
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

TEST(FinalNames, AreThoseThatWereAskedFor) {
  std::string file;
  {
    const PartialFile partial("/out/a b.h5");
    file = partial.path();
    EXPECT_EQ(with_final_names(file + ": HDF5 could not write"), "/out/a b.h5: HDF5 could not write");
  }
  EXPECT_EQ(with_final_names("no room for /out/.set.partial-12.host.example.0123456789abcdef/episode.hdf5: none"),
            "no room for /out/set/episode.hdf5: none");
  EXPECT_EQ(with_final_names("file:/o/.p.partial-1.vm.0123456789abcdef/x and .q.png.partial-1.vm.0123456789abcdef.png"),
            "file:/o/p/x and q.png");
  EXPECT_EQ(with_final_names("/out/.hidden/file.partial.h5: text"), "/out/.hidden/file.partial.h5: text");
}

}  // namespace
}  // namespace pvg
