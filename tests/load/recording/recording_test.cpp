#include "host/load/recording/recording.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "host/base/error.hpp"
#include "host/hdf5/file.hpp"
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

const std::string LONG_RUN =
    "t,q,i\n0,1,10\n0.1,2,20\n0.2,3,30\n0.3,4,40\n0.4,5,50\n0.5,6,60\n0.6,7,70\n0.7,8,80\n0.8,9,90\n0.9,10,100\n";
const std::string ANGLE = "  - {column: q, kind: position, joint: hinge, unit: deg}\n";

void write_run(const TestFolder& folder, const std::string& run, const std::string& rest) {
  folder.write("scene.yaml", "schema: 1\n");
  folder.write("a.csv", LONG_RUN);
  folder.write("recording.yaml", "schema: 1\nscene: scene.yaml\nruns:\n  - {" + run + "}\nchannels:\n" + ANGLE + rest);
}

TEST(Recording, ARunBeginsAndEndsWhereItSays) {
  const TestFolder folder;
  write_run(folder, "file: a.csv, role: fit, from: 100 ms, to: 0.85 s", "");
  const MeasuredTable table = load_recording(folder.path).runs[0].table;
  EXPECT_EQ(table.n_rows, 8u);
  EXPECT_EQ(table["t"].front(), 0.1);
  EXPECT_EQ(table["q"], (std::vector<double>{2, 3, 4, 5, 6, 7, 8, 9}));
  write_run(folder, "file: a.csv, role: fit, from: 0.35 s", "");
  expect_error<UsageError>([&] { load_recording(folder.path); }, {"recording.yaml", "runs[0].from", "6 rows", "8"});
}

TEST(Recording, ACommandedCurrentIsAnEffort) {
  const TestFolder folder;
  const auto inputs = [](const std::string& more) {
    return "inputs:\n  - {column: i, target: joint/hinge/current, " + more + "}\n";
  };
  write_run(folder, "file: a.csv, role: fit", inputs("constant: 0.05 N m/A, unit: mA"));
  const Recording r = load_recording(folder.path);
  ASSERT_EQ(r.inputs.size(), 1u);
  EXPECT_EQ(r.inputs[0].target, "joint/hinge/torque");
  EXPECT_EQ(r.inputs[0].unit, "N m");
  EXPECT_NEAR(r.runs[0].table[r.inputs[0].columns[0]][2], 30e-3 * 0.05, 1e-15);
  const auto refused = [&](const std::string& more, std::initializer_list<const char*> words) {
    write_run(folder, "file: a.csv, role: fit", inputs(more));
    expect_error<UsageError>([&] { load_recording(folder.path); }, words);
  };
  refused("constant: 0.05, unit: A", {"inputs[0].constant", "0.05 N m/A"});
  refused("constant: 0 N m/A, unit: A", {"inputs[0].constant"});
  refused("constant: nan N m/A, unit: A", {"inputs[0].constant"});
  refused("constant: 1e400 N m/A, unit: A", {"inputs[0].constant"});
  refused("constant: 0.05 N m/A, unit: V", {"inputs[0].unit", "A or mA"});
}

// 3 cm^2 at 2 bar: 60 N; a rotary vane of 5 cm^3 per radian at 40 kPa: 0.2 N m
TEST(Recording, ACommandedPressureIsAnEffort) {
  const TestFolder folder;
  const auto effort_of = [&](const std::string& more) {
    write_run(folder, "file: a.csv, role: fit",
              "inputs:\n  - {column: i, target: joint/slide/pressure, " + more + "}\n");
    const Recording r = load_recording(folder.path);
    EXPECT_EQ(r.inputs.at(0).target, "joint/slide/torque");
    const double commanded = r.runs[0].table["i"][2];
    return std::pair(r.runs[0].table[r.inputs[0].columns[0]][2] / commanded, r.inputs[0].unit);
  };
  EXPECT_NEAR(effort_of("constant: 3e-4 N/Pa, unit: bar").first, 60. / 2, 1e-12);
  EXPECT_NEAR(effort_of("constant: 5e-6 N m/Pa, unit: kPa").first, 0.2 / 40, 1e-15);
  EXPECT_EQ(effort_of("constant: 5e-6 N m/Pa, unit: Pa").second, "N m");
  expect_error<UsageError>([&] { effort_of("constant: 3e-4 N/Pa, unit: A"); },
                           {"inputs[0].unit", "Pa, kPa, MPa or bar"});
  expect_error<UsageError>([&] { effort_of("constant: 0.05 N m/A, unit: Pa"); }, {"inputs[0].constant", "N/Pa"});
}

TEST(Recording, SaysWhatItDoesNotReadAndWhichColumnsThereAre) {
  const TestFolder folder;
  write_run(folder, "file: a.mcap, role: fit", "");
  folder.write("a.mcap", "");
  expect_error<UsageError>([&] { load_recording(folder.path); }, {"a.mcap", "scripts/convert_log.py"});
  write_run(folder, "file: a.csv, role: fit", "  - {column: angle, kind: rate, joint: hinge}\n");
  expect_error<UsageError>([&] { load_recording(folder.path); }, {"`angle`", "a.csv", "there are: i, q, t"});
}

// n masks of 2 x 2 pixels in which frame i shows `finger` at pixel i mod 4
void write_masks(const std::filesystem::path& path, std::size_t n, const std::vector<double>& time) {
  hdf5::File file = hdf5::File::create(path);
  std::vector<std::uint8_t> pixels(4 * n, 0);
  for (std::size_t i = 0; i < n; ++i) pixels[4 * i + i % 4] = 2;
  file.write("/part", {n, 2, 2}, pixels);
  file.attribute("/part", "names", std::vector<std::string>{"nothing", "hand", "finger"});
  if (!time.empty()) file.write("/time", {time.size()}, time);
  file.close();
}
const std::string MASK = "  - {file: \"{run}.h5\", kind: mask, camera: wrist, part: finger}\n";

TEST(Recording, AMaskBecomesOneChannelPerMoment) {
  const TestFolder folder;
  write_masks(folder.path / "a.h5", 3, {0.1, 0.35, 0.6});  // the second is of no row
  const Recording r = load_recording(recording(folder, MASK));
  ASSERT_EQ(r.channels.size(), 6u);
  EXPECT_EQ(r.runs[0].masks[0].frame_of_row, (std::vector<int>{-1, 0, -1, -1, -1, -1, 2, -1}));
  const auto value = [&](std::size_t channel, std::size_t row) {
    return r.runs[0].table[r.channels[channel].columns[0]][row];
  };
  EXPECT_TRUE(std::isnan(value(0, 0)));
  EXPECT_DOUBLE_EQ(value(0, 1), 0.25);
  EXPECT_DOUBLE_EQ(value(1, 1), -0.125);  // pixel 0, upper left: x = y = -1/2
  EXPECT_DOUBLE_EQ(value(2, 1), -0.125);
  EXPECT_DOUBLE_EQ(value(1, 6), -0.125);  // frame 2, pixel 2, lower left
  EXPECT_DOUBLE_EQ(value(2, 6), 0.125);
}

TEST(Recording, MasksThatDoNotFitAreNamed) {
  const TestFolder folder;
  const auto refused = [&](std::initializer_list<const char*> words, const std::string& channel = MASK) {
    expect_error<UsageError>([&] { load_recording(recording(folder, channel)); }, words);
  };
  refused({"a.h5"});
  write_masks(folder.path / "a.h5", 3, {});
  refused({"a.h5", "holds 3 masks", "8 rows"});
  write_masks(folder.path / "a.h5", 3, {5, 6, 7});
  refused({"a.h5", "no mask has the time of a row"});
  write_masks(folder.path / "a.h5", 3, {0.1, 0.2});
  refused({"a.h5", "/time has 2 numbers for 3 masks"});
  write_masks(folder.path / "a.h5", 8, {});
  refused({"a.h5", "no part `thumb`", "hand, finger"}, "  - {file: a.h5, kind: mask, camera: wrist, part: thumb}\n");
  folder.write("a.h5", "not HDF5");
  refused({"a.h5"});
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

// An encoder at 20 Hz, 40 ms late by its maker's word, beside commands at 10 Hz.
TEST(Recording, AChannelMayHaveAFileAndAClockOfItsOwn) {
  const TestFolder folder;
  folder.write("a_encoder.csv", "stamp,angle\n0.04,10\n0.09,11\n0.14,12\n0.19,13\n0.24,14\n");
  const Recording r = load_recording(recording(
      folder,
      "  - {column: q, kind: position, joint: hinge}\n"
      "  - {file: \"{run}_encoder.csv\", time: stamp, column: angle, kind: position, joint: hinge, latency: 40 ms}\n"));
  const MeasuredTable& table = r.runs[0].table;
  const std::vector<double>&t = table["t"], &q = table["q"], &angle = table[r.channels[1].columns[0]];
  ASSERT_EQ(t.size(), 10u);  // 0, 0.05, 0.1, 0.15, 0.2, 0.3, ..
  EXPECT_NEAR(t[1], 0.05, 1e-12);
  EXPECT_EQ(q[0], 1);
  EXPECT_TRUE(std::isnan(q[1]));
  EXPECT_EQ(q[2], 2);
  EXPECT_EQ(angle[0], 10);
  EXPECT_EQ(angle[1], 11);
  EXPECT_EQ(angle[4], 14);
  EXPECT_TRUE(std::isnan(angle[5]));
}

// A clock that counts from its own start and runs 1 % fast: 1.01 of its seconds are one of the run's.
TEST(Recording, TwoClocksAreBroughtTogether) {
  const TestFolder folder;
  folder.write("camera.csv", "t,x\n100,1\n100.101,2\n100.202,3\n100.909,4\n");
  const Recording r = load_recording(recording(
      folder,
      "  - {file: camera.csv, column: x, kind: position, joint: hinge, clock: {offset: -99.00990099009901, rate: "
      "0.990099009900990099}}\n"));
  const MeasuredTable& table = r.runs[0].table;
  const std::vector<double>& x = table[r.channels[0].columns[0]];
  ASSERT_EQ(table.n_rows, 8u);  // the last sample is from after the run
  EXPECT_EQ(x[0], 1);
  EXPECT_EQ(x[1], 2);
  EXPECT_EQ(x[2], 3);
}

TEST(Recording, AChannelsOwnTableMayBeArraysOfAFileWithOthers) {
  const TestFolder folder;
  hdf5::File file = hdf5::File::create(folder.path / "log.h5");
  file.write("/camera/t", {3}, std::vector<double>{0.1, 0.2, 0.3});
  file.write("/camera/x", {3}, std::vector<double>{5, 6, 7});
  file.write("/imu", {2}, std::vector<double>{0, 1});
  file.close();
  const Recording r = load_recording(
      recording(folder, "  - {file: log.h5, time: camera/t, column: camera/x, kind: position, joint: hinge}\n"));
  EXPECT_EQ(r.runs[0].table[r.channels[0].columns[0]][2], 6);
}

TEST(Recording, WhatIsWrongWithAClockIsNamed) {
  const TestFolder folder;
  const auto refused = [&](const std::string& file, std::initializer_list<const char*> words,
                           const std::string& keys = "") {
    folder.write("e.csv", file);
    const std::string channel = "  - {file: e.csv, column: x, kind: position, joint: hinge" + keys + "}\n";
    expect_error<UsageError>([&] { load_recording(recording(folder, channel)); }, words);
  };
  refused("s,x\n0,1\n", {"e.csv", "no column `t`"});
  refused("t,y\n0,1\n", {"e.csv", "no column `x`"});
  refused("t,x\n", {"e.csv", "holds no rows"});
  refused("t,x\n0,1\n0,2\n", {"e.csv", "row 2", "come after"});
  refused("t,x\n0,1\n,2\n", {"e.csv", "row 2", "missing"});
  refused("t,x\n5,1\n6,2\n", {"e.csv", "from 5", "to 6", "a.csv", "clock: {offset"});
  refused("t,x\n0,1\n0.1,2\n", {"latency"}, ", latency: 20 m");
}

}  // namespace
}  // namespace pvg
