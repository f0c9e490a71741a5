#include "pipeline/episode/fidelity.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "host/base/counted.hpp"
#include "host/base/error.hpp"
#include "host/formats/part_masks.hpp"
#include "host/pictures/mask_metrics.hpp"
#include "host/pictures/picture_metrics.hpp"
#include "host/pictures/srgb.hpp"

namespace pvg {
namespace {

namespace fs = std::filesystem;

constexpr const char* CONTACT_SHEET = "contact_sheet.png";

bool is_picture(const fs::path& file) {
  const std::string suffix = file.extension().string();
  return suffix == ".png" || suffix == ".jpg" || suffix == ".jpeg";
}

void read_mask_pictures(const fs::path& folder, const std::string& part, SeenFolder& seen) {
  for (const fs::directory_entry& entry : fs::directory_iterator(folder))
    if (is_picture(entry.path())) seen.masks[part][entry.path().stem().string()] = read_mask_picture(entry.path());
}

// CAMERA_masks.h5, or masks.h5
void read_mask_file(const fs::path& file, SeenFolder& seen) {
  std::string camera = file.stem().string();
  camera.resize(camera.size() - std::string("masks").size());  // "wrist_", or nothing
  for (const std::string& part : named_parts(file)) {
    PartMasks masks = read_part_masks(file, part);
    for (std::size_t i = 0; i < masks.pixels.size(); ++i)
      seen.masks[part][fmt::format("{}{:06}", camera, i)] = {masks.width, masks.height, std::move(masks.pixels[i])};
  }
}

void demand_equal_size(const std::string& what, int width, int height, int other_width, int other_height) {
  if (width == other_width && height == other_height) return;
  throw UsageError(
      fmt::format("{} has {} x {} pixels in the first folder and {} x {} in the second; render at the size "
                  "of the real pictures",
                  what, width, height, other_width, other_height));
}

std::vector<float> values_of(const Picture8& picture) {
  std::vector<float> values(picture.rgb.size());
  std::transform(picture.rgb.begin(), picture.rgb.end(), values.begin(),
                 [](std::uint8_t byte) { return float(byte) / 255.0f; });
  return values;
}

std::vector<float> through(const Lut& lut, std::vector<float> values) {
  for (float& v : values) v = srgb_to_linear(v);
  apply_lut(lut, values);
  for (float& v : values) v = linear_to_srgb(std::clamp(v, 0.0f, 1.0f));
  return values;
}

// of the frames of both, in the order of their names
std::set<std::string> common_frames(const SeenFolder& real, const SeenFolder& simulated) {
  std::set<std::string> names;
  for (const auto& [name, file] : real.pictures)
    if (simulated.pictures.count(name)) names.insert(name);
  for (const auto& [part, masks] : real.masks) {
    const auto other = simulated.masks.find(part);
    if (other == simulated.masks.end()) continue;
    for (const auto& [name, mask] : masks)
      if (other->second.count(name)) names.insert(name);
  }
  return names;
}

void compare_masks(const SeenFolder& real, const SeenFolder& simulated, FrameFidelity& frame) {
  for (const auto& [part, masks] : real.masks) {
    const auto others = simulated.masks.find(part);
    if (others == simulated.masks.end()) continue;
    const auto a = masks.find(frame.frame), b = others->second.find(frame.frame);
    if (a == masks.end() || b == others->second.end()) continue;
    demand_equal_size("mask " + frame.frame + " of " + part, a->second.width, a->second.height, b->second.width,
                      b->second.height);
    frame.overlap[part] = mask_overlap(a->second.pixels, b->second.pixels);
  }
}

void compare_pictures(const SeenFolder& real, const SeenFolder& simulated, const FidelitySettings& settings,
                      FrameFidelity& frame) {
  const auto a = real.pictures.find(frame.frame), b = simulated.pictures.find(frame.frame);
  if (a == real.pictures.end() || b == simulated.pictures.end()) return;
  const Picture8 truth = read_picture(a->second), other = read_picture(b->second);
  demand_equal_size("picture " + frame.frame, truth.width, truth.height, other.width, other.height);
  const std::vector<float> x = values_of(truth), y = values_of(other);
  frame.psnr = psnr(x, y);
  frame.ssim = ssim(x, y, truth.width, truth.height);
  if (!settings.lut) return;
  const std::vector<float> mapped = through(*settings.lut, y);
  frame.lut_psnr = psnr(x, mapped);
  frame.lut_ssim = ssim(x, mapped, truth.width, truth.height);
}

std::optional<MeanInterval> mean_of(const std::vector<FrameFidelity>& frames, std::size_t stretch,
                                    std::optional<double> FrameFidelity::*number) {
  std::vector<double> values;
  for (const FrameFidelity& frame : frames)
    if (frame.*number) values.push_back(*(frame.*number));
  if (values.empty()) return std::nullopt;
  return bootstrap_mean(values, stretch);
}

}  // namespace

SeenFolder read_seen_folder(const fs::path& folder) {
  if (!fs::is_directory(folder)) throw UsageError(folder.string() + ": there is no such folder of pictures or masks");
  SeenFolder seen;
  seen.folder = folder;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    if (name == CONTACT_SHEET) continue;  // of an episode: many frames in one
    if (is_picture(entry.path()))
      seen.pictures[entry.path().stem().string()] = entry.path();
    else if (name == "masks.h5" || name.ends_with("_masks.h5"))
      read_mask_file(entry.path(), seen);
  }
  if (fs::is_directory(folder / "masks")) {
    read_mask_pictures(folder / "masks", "gripper", seen);
    for (const fs::directory_entry& entry : fs::directory_iterator(folder / "masks"))
      if (entry.is_directory()) read_mask_pictures(entry.path(), entry.path().filename().string(), seen);
  }
  if (seen.pictures.empty() && seen.masks.empty())
    throw UsageError(folder.string() +
                     " holds neither pictures (NAME.png) nor masks (masks/NAME.png, CAMERA_masks.h5); name a folder of "
                     "`phyvisgen render` or an episode");
  return seen;
}

Fidelity compare(const SeenFolder& real, const SeenFolder& simulated, const FidelitySettings& settings) {
  const std::set<std::string> names = common_frames(real, simulated);
  if (names.empty())
    throw UsageError("no picture or mask in " + simulated.folder.string() + " has the name of one in " +
                     real.folder.string() + "; pairs are found by their names, such as wrist_000000.png");
  Fidelity fidelity;
  std::size_t i = 0;
  for (const std::string& name : names) {
    const std::size_t at = i++;
    if (at < settings.first || at >= settings.last) continue;
    FrameFidelity frame;
    frame.frame = name;
    compare_masks(real, simulated, frame);
    compare_pictures(real, simulated, settings, frame);
    fidelity.n_pictures += frame.psnr.has_value();
    for (const auto& [part, overlap] : frame.overlap) ++fidelity.n_masks[part];
    fidelity.frames.push_back(std::move(frame));
  }
  if (fidelity.frames.empty())
    throw UsageError(fmt::format("the folders have {} in common; those asked for are not among them",
                                 counted(names.size(), "frame")));
  for (const auto& [part, n] : fidelity.n_masks) {
    std::vector<double> values;
    for (const FrameFidelity& frame : fidelity.frames)
      if (frame.overlap.count(part)) values.push_back(frame.overlap.at(part));
    fidelity.overlap[part] = bootstrap_mean(values, settings.stretch);
  }
  fidelity.psnr = mean_of(fidelity.frames, settings.stretch, &FrameFidelity::psnr);
  fidelity.ssim = mean_of(fidelity.frames, settings.stretch, &FrameFidelity::ssim);
  fidelity.lut_psnr = mean_of(fidelity.frames, settings.stretch, &FrameFidelity::lut_psnr);
  fidelity.lut_ssim = mean_of(fidelity.frames, settings.stretch, &FrameFidelity::lut_ssim);
  return fidelity;
}

}  // namespace pvg
