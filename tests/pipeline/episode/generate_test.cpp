// The command `generate` and the folder that it fills: stopping leaves nothing half-written, finished episodes are left
// alone, what failed has its reason, and folders of another origin are refused.
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <map>
#include <thread>

#include "host/base/error.hpp"
#include "host/hdf5/file.hpp"
#include "pipeline/episode/episode_set.hpp"

namespace pvg {
namespace {

namespace fs = std::filesystem;

struct Generate : testing::Test {
  Generate() { fs::create_directories(out); }
  ~Generate() override { fs::remove_all(out); }
  std::vector<std::string> entries() const {
    std::vector<std::string> names;
    for (const fs::directory_entry& entry : fs::directory_iterator(out)) names.push_back(entry.path().filename());
    std::sort(names.begin(), names.end());
    return names;
  }
  void put(const fs::path& file, const std::string& text) {
    fs::create_directories((out / file).parent_path());
    std::ofstream(out / file) << text;
  }
  std::string text_of(const fs::path& file) const {
    std::ifstream in(out / file);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  EpisodeSet a_set() const {
    EpisodeSet set;
    set.folder = out;
    set.task = "weigh_beaker";
    set.seed = 4;
    set.n_asked = 3;
    set.configuration = fingerprint("text");
    return set;
  }
  const fs::path out = fs::temp_directory_path() / ("pvg_generate_" + std::to_string(getpid()));
};

TEST_F(Generate, AStopEndsWithCode75AndLeavesNothingHalfWritten) {
  const std::string task = PVG_DATA_FOLDER "/tasks/weigh_beaker.yaml", folder = out.string();
  const pid_t child = fork();
  if (child == 0) {
    if (!freopen("/dev/null", "w", stderr)) _exit(99);
    execl(PVG_PROGRAM, "phyvisgen", "generate", task.c_str(), "-o", folder.c_str(), "--no-render", nullptr);
    _exit(99);
  }
  // until its first states are being written
  const auto is_under_way = [&] {
    const std::vector<std::string> names = entries();
    return std::any_of(names.begin(), names.end(), [&](const std::string& name) {
      return name.starts_with(".episode_000000.partial-") && fs::exists(out / name / "states.h5");
    });
  };
  for (int i = 0; i < 1200 && !is_under_way(); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(100));
  ASSERT_TRUE(is_under_way());
  kill(child, SIGUSR1);  // which LLVM, compiling kernels, takes to itself where it can
  int status = 0;
  waitpid(child, &status, 0);
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 75);
  EXPECT_EQ(entries(), std::vector<std::string>{"set.json"});
}

TEST_F(Generate, FinishedEpisodesAreLeftAlone) {
  put("episode_000000/summary.json", "{}");
  const std::string command = std::string(PVG_PROGRAM) + " generate " PVG_DATA_FOLDER "/tasks/weigh_beaker.yaml -o " +
                              out.string() + " -n 1 --json >" + (out / "stdout").string() + " 2>/dev/null";
  EXPECT_EQ(std::system(command.c_str()), 0);
  EXPECT_EQ(text_of("episode_000000/summary.json"), "{}");
  EXPECT_NE(text_of("stdout").find("\"done\": [\n    0\n  ]"), std::string::npos) << text_of("stdout");
}

TEST_F(Generate, WhatFailedBeforeIsCountedAndNotMadeAgain) {
  put("failed/episode_000000/summary.json", R"({"reason": "the beaker fell"})");
  const std::string command = std::string(PVG_PROGRAM) + " generate " PVG_DATA_FOLDER "/tasks/weigh_beaker.yaml -o " +
                              out.string() + " -n 1 >/dev/null 2>" + (out / "stderr").string();
  const int status = std::system(command.c_str());
  EXPECT_EQ(WEXITSTATUS(status), 1);
  EXPECT_NE(text_of("stderr").find("episode 0 failed: the beaker fell"), std::string::npos) << text_of("stderr");
  EXPECT_FALSE(fs::exists(out / "episode_000000"));
}

void replace(std::string& text, const std::string& from, const std::string& to) {
  ASSERT_NE(text.find(from), std::string::npos) << from;
  for (std::size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size())
    text.replace(at, from.size(), to);
}

// push_beaker.yaml, to be written anywhere
std::string push_beaker_text() {
  const fs::path folder = fs::path(PVG_DATA_FOLDER).parent_path() / "tests/pipeline/small_task";
  std::ifstream in(folder / "push_beaker.yaml");
  std::string task(std::istreambuf_iterator<char>(in), {});
  replace(task, "../../../data", PVG_DATA_FOLDER);
  replace(task, "gripper: gripper.yaml", "gripper: " + (folder / "gripper.yaml").string());
  return task;
}

// Pushes that the record does not call wanted: /a is that of the episode without them to the bit, the hand is where
// they put it. The same seed gives the same bytes.
TEST_F(Generate, ADisturbedHandIsRecordedWithTheTargetsThatLeadItBack) {
  const std::string task = push_beaker_text();
  put("plain.yaml", task);
  put("pushed.yaml",
      task +
          "\nvary:\n  - {quantity: disturbance, of: gripper_base, by: [4 mm, 8 mm], duration: 0.2, times: 2, "
          "during: [approach]}\n");
  put("grip.yaml", task + "\nvary: [{quantity: disturbance, of: gripper_base, by: 4 mm, during: [close]}]\n");
  const auto run = [&](const std::string& name, const std::string& set) {
    const int status = std::system((std::string(PVG_PROGRAM) + " generate " + (out / (name + ".yaml")).string() +
                                    " -n 1 --seed 3 --no-render --keep-failed -o " + (out / set).string() +
                                    " >/dev/null 2>" + (out / "stderr").string())
                                       .c_str());
    return WEXITSTATUS(status);
  };
  EXPECT_EQ(run("grip", "grip"), 2);
  EXPECT_NE(text_of("stderr").find("`close`"), std::string::npos) << text_of("stderr");
  ASSERT_EQ(run("plain", "plain"), 0) << text_of("stderr");
  ASSERT_EQ(run("pushed", "pushed"), 0) << text_of("stderr");
  ASSERT_EQ(run("pushed", "again"), 0) << text_of("stderr");
  EXPECT_EQ(text_of("pushed/episode_000000/states.h5"), text_of("again/episode_000000/states.h5"));
  const auto open = [&](const std::string& set) { return hdf5::File::open(out / set / "episode_000000/states.h5"); };
  const hdf5::File plain = open("plain"), pushed = open("pushed");
  EXPECT_FALSE(plain.has("/disturbance"));
  EXPECT_EQ(plain.read<double>("/a").values, pushed.read<double>("/a").values);
  const std::vector<double> a = pushed.read<double>("/a").values, q = pushed.read<double>("/q").values,
                            d = pushed.read<double>("/disturbance").values;
  const std::size_t width = pushed.texts_attribute("/q", "names").size(), n_steps = q.size() / width;
  ASSERT_EQ(d.size(), q.size());
  int n_pushed = 0;
  for (std::size_t step = 0; step < n_steps; ++step) {
    double largest = 0, off_the_push = 0;
    for (std::size_t j = 0; j < width; ++j) {
      const std::size_t i = step * width + j;
      largest = std::max(largest, std::abs(d[i]));
      off_the_push = std::max(off_the_push, std::abs(q[i] - a[i] - d[i]));
    }
    n_pushed += largest > 0;
    if (largest > 0) {
      EXPECT_LT(off_the_push, 2e-3) << step;  // the lag of its drives
    }
  }
  EXPECT_EQ(n_pushed, 2 * 9);  // of 10 steps of 20 ms; after the last the hand is on its way again
  double farthest = 0;
  for (const double number : d) farthest = std::max(farthest, std::abs(number));
  EXPECT_GT(farthest, 5e-3);
}

// Everything in the set that is of its episodes, by path: their bytes, and of a summary what does not tell of time.
std::map<std::string, std::string> contents(const fs::path& set) {
  std::map<std::string, std::string> files;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(set)) {
    if (!entry.is_regular_file() || entry.path().filename() == "set.json") continue;
    std::ifstream in(entry.path(), std::ios::binary);
    std::string& text = files[fs::relative(entry.path(), set)];
    text.assign(std::istreambuf_iterator<char>(in), {});
    if (entry.path().filename() == "summary.json") text.resize(text.find("\"seconds\""));
  }
  return files;
}

// Five episodes of other lengths, of which some begin in the table; with pictures.
TEST_F(Generate, EpisodesThatStepTogetherHaveTheBitsTheyHaveAlone) {
  std::string task = push_beaker_text();
  replace(task, "x: [0.420, 0.424]", "x: [0.41, 0.44]");
  replace(task, "z: 0.5 mm", "z: [-0.2 mm, 0.6 mm]");
  replace(task, "at_most: 12 mm", "at_most: 16 mm");
  put("task.yaml", task);
  std::map<std::string, std::string> alone;
  for (const std::string worlds : {"1", "3", "5"}) {
    const fs::path set = out / worlds;
    const int status = std::system((std::string(PVG_PROGRAM) + " generate " + (out / "task.yaml").string() +
                                    " -n 5 --seed 3 --keep-failed --worlds " + worlds + " -o " + set.string() +
                                    " >/dev/null 2>" + (out / "stderr").string())
                                       .c_str());
    EXPECT_EQ(WEXITSTATUS(status), 1) << text_of("stderr");  // some failed
    const std::map<std::string, std::string> files = contents(set);
    if (worlds == "1") {
      alone = files;
      const SetStatus made = read_status(set);
      EXPECT_GE(made.done.size(), 2u);
      EXPECT_GE(made.failed.size(), 1u);
      EXPECT_NE(made.failed.at(0).reason.find("intersect"), std::string::npos) << made.failed.at(0).reason;
      continue;
    }
    ASSERT_EQ(files.size(), alone.size());
    for (const auto& [name, bytes] : alone) {
      ASSERT_TRUE(files.contains(name)) << name;
      EXPECT_TRUE(files.at(name) == bytes) << name << " with " << worlds << " worlds";
    }
  }
}

TEST_F(Generate, ChosenCamerasAloneAreRenderedAndTheMotionIsTheSame) {
  std::string task = push_beaker_text();
  const std::string more =
      "cameras:\n  - {name: back, width: 24, height: 16, vertical_field_of_view: 44 deg, position: [0, 0.5, 0.3], "
      "look_at: [0.4, 0, 0.06], up: [0, 0, 1]}\n";
  replace(task, "cameras:\n", more);
  put("task.yaml", task);
  const auto generate = [&](const std::string& words) {
    return WEXITSTATUS(std::system((std::string(PVG_PROGRAM) + " generate " + (out / "task.yaml").string() + " -o " +
                                    out.string() + "/" + words + " >/dev/null 2>" + (out / "stderr").string())
                                       .c_str()));
  };
  // what the summary tells of the motion
  const auto measured = [&](const std::string& set) {
    const std::string text = text_of(set + "/episode_000000/summary.json");
    return text.substr(text.find("\"measured\""), text.find("\"meshes\"") - text.find("\"measured\""));
  };
  ASSERT_EQ(generate("all"), 0) << text_of("stderr");
  ASSERT_EQ(generate("one --camera back"), 0) << text_of("stderr");
  EXPECT_TRUE(fs::exists(out / "all/episode_000000/front.mp4"));
  EXPECT_TRUE(fs::exists(out / "one/episode_000000/back.mp4"));
  EXPECT_FALSE(fs::exists(out / "one/episode_000000/front.mp4"));
  EXPECT_EQ(text_of("one/episode_000000/summary.json").find("\"front\""), std::string::npos);
  EXPECT_EQ(measured("one"), measured("all"));
  EXPECT_EQ(generate("one --camera front"), 2);  // other pictures than those of the set
  EXPECT_EQ(generate("none --camera side"), 2);
  EXPECT_NE(text_of("stderr").find("--camera side is no camera of"), std::string::npos) << text_of("stderr");
  EXPECT_EQ(generate("none --camera back --no-render"), 2);
}

TEST_F(Generate, TheStatusIsReadOffTheFolder) {
  put("episode_000002/summary.json", "{}");
  put("episode_000000/summary.json", "{}");
  put("failed/episode_000001/summary.json", "{\"reason\": \"dropped\"}");
  put("failed/episode_000002/summary.json", "{\"reason\": \"old, made since\"}");
  put("episode_7/summary.json", "{}");                  // no name of ours
  put(".episode_000005.partial-1/summary.json", "{}");  // in the making
  const SetStatus status = read_status(out);
  EXPECT_EQ(status.done, (std::vector<std::uint64_t>{0, 2}));
  ASSERT_EQ(status.failed.size(), 1u);
  EXPECT_EQ(status.failed[0].episode, 1u);
  EXPECT_EQ(status.failed[0].reason, "dropped");
  write_set(a_set());
  EXPECT_NE(text_of("set.json").find("\"reason\": \"dropped\""), std::string::npos);
}

TEST_F(Generate, AFolderOfAnotherOriginIsRefusedAndTheLastNumberAskedForCounts) {
  write_set(a_set());
  EpisodeSet same = a_set(), seed = a_set(), task = a_set(), configuration = a_set();
  same.n_asked = 1;
  join_set(same);
  EXPECT_EQ(same.n_asked, 1u);
  seed.seed = 5;
  EXPECT_THROW(join_set(seed), UsageError);
  task.task = "fold_cloth";
  EXPECT_THROW(join_set(task), UsageError);
  configuration.configuration = fingerprint("texts");
  EXPECT_THROW(join_set(configuration), UsageError);
}

TEST(Fingerprint, HasThePublishedValues) {
  EXPECT_EQ(fingerprint(""), "cbf29ce484222325");  // FNV-1a, 64 bits
  EXPECT_EQ(fingerprint("a"), "af63dc4c8601ec8c");
}

}  // namespace
}  // namespace pvg
