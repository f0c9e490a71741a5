// Folders of pictures and masks, compared: numbers by hand, pairs by name, and what is refused.
#include "pipeline/episode/fidelity.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "host/base/error.hpp"
#include "tests/temporary_folder.hpp"

namespace pvg {
namespace {

namespace fs = std::filesystem;

// a mask of `width` columns from the left, 8 x 4 pixels
void write_mask(const fs::path& file, int width) {
  fs::create_directories(file.parent_path());
  Picture8 mask{8, 4, std::vector<std::uint8_t>(96)};
  for (std::size_t i = 0; i < 96; ++i) mask.rgb[i] = int(i / 3 % 8) < width ? 255 : 0;
  write_picture(file, mask);
}

void write_grey(const fs::path& file, std::uint8_t value) {
  fs::create_directories(file.parent_path());
  write_picture(file, {8, 4, std::vector<std::uint8_t>(96, value)});
}

TEST(Fidelity, MasksAreComparedByPartAndName) {
  const TestFolder folder;
  const fs::path real = folder.path / "real", simulated = folder.path / "sim";
  write_mask(real / "masks/a.png", 4);
  write_mask(simulated / "masks/a.png", 2);
  write_mask(real / "masks/b.png", 4);
  write_mask(simulated / "masks/b.png", 8);
  write_mask(simulated / "masks/c.png", 8);  // of no real one
  write_mask(real / "masks/left/a.png", 3);
  write_mask(simulated / "masks/left/a.png", 3);
  const Fidelity fidelity = compare(read_seen_folder(real), read_seen_folder(simulated), {});
  ASSERT_EQ(fidelity.frames.size(), 2u);
  EXPECT_DOUBLE_EQ(fidelity.frames[0].overlap.at("gripper"), 0.5);
  EXPECT_DOUBLE_EQ(fidelity.frames[1].overlap.at("gripper"), 0.5);
  EXPECT_DOUBLE_EQ(fidelity.overlap.at("left").mean, 1);
  EXPECT_EQ(fidelity.n_masks.at("left"), 1u);
  const auto json = nlohmann::json::parse(fidelity_json(fidelity, {{"rigid", fidelity}}));
  EXPECT_EQ(json["mask"]["miou"], 0.5);
  EXPECT_EQ(json["mask"]["frames"], 2);
  EXPECT_EQ(json["baselines"]["rigid"]["mask"]["parts"]["left"]["mean"], 1);
}

// grey 100 against 151: 20 log10(255 / 51) dB
TEST(Fidelity, PicturesAreComparedAndReported) {
  const TestFolder folder;
  const fs::path real = folder.path / "real", simulated = folder.path / "sim", report = folder.path / "report";
  for (const char* name : {"0.png", "1.png", "2.png"}) {
    write_grey(real / name, 100);
    write_grey(simulated / name, 151);
  }
  write_grey(real / "contact_sheet.png", 0);
  write_grey(simulated / "contact_sheet.png", 255);
  const SeenFolder a = read_seen_folder(real), b = read_seen_folder(simulated);
  FidelitySettings settings;
  settings.first = 1;
  const Fidelity fidelity = compare(a, b, settings);
  EXPECT_EQ(fidelity.n_pictures, 2u);
  EXPECT_NEAR(fidelity.psnr->mean, 20 * std::log10(5), 1e-5);
  write_fidelity_report(report, a, b, fidelity, {}, 1);
  EXPECT_TRUE(fs::exists(report / "index.html"));
  EXPECT_TRUE(fs::exists(report / "report.json"));
  EXPECT_TRUE(fs::exists(report / "errors/1.png"));
  EXPECT_FALSE(fs::exists(report / "errors/2.png"));  // one frame is shown
}

TEST(Fidelity, WhatDoesNotFitIsRefused) {
  const TestFolder folder;
  write_grey(folder.path / "real/a.png", 1);
  write_grey(folder.path / "other/b.png", 1);
  write_picture(folder.path / "real/large.png", {4, 4, std::vector<std::uint8_t>(48)});
  write_grey(folder.path / "sim/large.png", 1);
  fs::create_directories(folder.path / "empty");
  const SeenFolder real = read_seen_folder(folder.path / "real");
  EXPECT_THROW(compare(real, read_seen_folder(folder.path / "other"), {}), UsageError);
  EXPECT_THROW(compare(real, read_seen_folder(folder.path / "sim"), {}), UsageError);
  EXPECT_THROW(read_seen_folder(folder.path / "empty"), UsageError);
  write_grey(folder.path / "faint/masks/a.png", 1);
  EXPECT_THROW(read_seen_folder(folder.path / "faint"), UsageError);
}

}  // namespace
}  // namespace pvg
