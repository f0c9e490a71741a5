#include "host/io/recording.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "host/base/error.hpp"
#include "tests/expect_error.hpp"
#include "tests/temporary_folder.hpp"

namespace pvg {
namespace {

const std::string RUN = "t,q\n0,1\n0.1,2\n0.2,\n0.3,nan\n0.4,5\n0.5,6\n0.6,7\n0.7,8\n";
const std::string HEAD = "schema: 1\nscene: scene.yaml\nruns:\n  - {file: a.csv, role: fit}\nchannels:\n";

std::filesystem::path recording(const TestFolder& folder, const std::string& channels, const std::string& run = RUN) {
  folder.write("scene.yaml", "schema: 1\n");
  folder.write("a.csv", run);
  folder.write("recording.yaml", HEAD + channels);
  return folder.path;
}

TEST(Recording, GapsAreNaNAndUnknownNoiseIsNegative) {
  const TestFolder folder;
  const Recording r =
      load_recording(recording(folder, "  - {column: q, kind: position, joint: hinge, unit: deg, noise: unknown}\n"));
  EXPECT_TRUE(std::isnan(r.runs[0].table["q"][2]));
  EXPECT_TRUE(std::isnan(r.runs[0].table["q"][3]));
  EXPECT_EQ(r.runs[0].table["q"][4], 5);
  EXPECT_LT(r.channels[0].noise, 0);
  EXPECT_EQ(r.initial, Recording::Initial::first_sample);
}

TEST(Recording, WhatIsWrongIsNamedWithFileAndKey) {
  const TestFolder folder;
  const auto refused = [&](const std::string& channels, std::initializer_list<const char*> words,
                           const std::string& run = RUN) {
    expect_error<UsageError>([&] { load_recording(recording(folder, channels, run)); }, words);
  };
  const std::string good = "  - {column: q, kind: position, joint: hinge}\n";
  refused("  - {column: p, kind: position, joint: hinge}\n", {"channels", "`p`", "a.csv"});
  refused("  - {column: q, kind: position, joint: hinge, noise: -1}\n", {"noise", "above 0"});
  refused("  - {column: q, kind: position, joint: hinge, body: cube}\n", {"either a `joint` or a `body`"});
  refused("  - {column: q, kind: position, body: cube}\n", {"3 columns", "axis"});
  refused("  - {column: q, kind: marker, body: cube, axis: [0, 0, 1]}\n", {"point", "vertex"});
  refused(good, {"a.csv", "row 3", "come after"}, "t,q\n0,1\n0.1,2\n0.1,3\n0.2,1\n0.3,1\n0.4,1\n0.5,1\n0.6,1\n");
  refused(good, {"a.csv", "column `t`"}, "time,q\n0,1\n");
  refused(good, {"a.csv", "at least 8"}, "t,q\n0,1\n");
}

}  // namespace
}  // namespace pvg
