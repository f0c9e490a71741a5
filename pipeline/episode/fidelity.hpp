// How near pictures and masks of a simulation are to those of reality, frame by frame.
#pragma once
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "host/base/bootstrap.hpp"
#include "host/formats/picture_files.hpp"
#include "host/pictures/lut.hpp"

namespace pvg {

// What a folder shows, by the names of its frames, such as wrist_000012.
//   NAME.png, .jpg           pictures
//   masks/NAME.png           masks of the part `gripper`;  masks/PART/NAME.png: of other parts
//   CAMERA_masks.h5          as generate writes them: frame i is CAMERA_00000i, all parts;  masks.h5: frame 00000i
struct SeenFolder {
  std::filesystem::path folder;
  std::map<std::string, std::filesystem::path> pictures;      // by frame
  std::map<std::string, std::map<std::string, Mask8>> masks;  // by part, then frame
};
// Throws a UsageError where the folder holds neither.
SeenFolder read_seen_folder(const std::filesystem::path& folder);

struct FrameFidelity {
  std::string frame;
  std::map<std::string, double> overlap;     // intersection over union, by part
  std::optional<double> psnr, ssim;          // [dB], 1
  std::optional<double> lut_psnr, lut_ssim;  // likewise after the table
};

// Means over the frames that have the number, 95 % intervals over stretches of time.
struct Fidelity {
  std::vector<FrameFidelity> frames;  // of both folders, by name
  std::map<std::string, MeanInterval> overlap;
  std::optional<MeanInterval> psnr, ssim, lut_psnr, lut_ssim;
  std::size_t n_pictures = 0;                  // pairs
  std::map<std::string, std::size_t> n_masks;  // pairs, by part
};

struct FidelitySettings {
  std::size_t first = 0, last = SIZE_MAX;  // frames first .. last - 1 of the names in both folders, in their order
  std::size_t stretch = 10;                // of the bootstrap [frames]
  std::optional<Lut> lut;                  // applied to the simulated pictures
};

// A UsageError where no frame is in both folders, or a pair differs in size.
Fidelity compare(const SeenFolder& real, const SeenFolder& simulated, const FidelitySettings& settings);

// index.html, report.json, overlays/FRAME_PART.png and errors/FRAME.png of at most `n_shown` frames, evenly spread.
// baselines: other simulations of the same frames, by name.
void write_fidelity_report(const std::filesystem::path& folder, const SeenFolder& real, const SeenFolder& simulated,
                           const Fidelity& fidelity, const std::map<std::string, Fidelity>& baselines,
                           std::size_t n_shown);

// {mask: {miou, low, high, frames, parts}, picture: {psnr, ssim, ..}, baselines: {NAME: {mask, picture}}}
std::string fidelity_json(const Fidelity& fidelity, const std::map<std::string, Fidelity>& baselines);

}  // namespace pvg
