// phyvisgen calibrate lut: a lookup table from rendered to recorded pictures.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <string>

#include "host/base/counted.hpp"
#include "host/base/error.hpp"
#include "host/base/outputs.hpp"
#include "host/formats/lut_file.hpp"
#include "host/formats/picture_files.hpp"
#include "host/pictures/picture_metrics.hpp"
#include "host/pictures/srgb.hpp"
#include "host/render/look.hpp"
#include "pipeline/command_line/command.hpp"

namespace pvg {
namespace {

namespace fs = std::filesystem;

struct CalibrateLutOptions {
  std::string rendered, real;  // folders of pictures, paired by name
  std::string output;          // .csv
  bool as_json = false;
};

constexpr std::size_t HELD_OUT = 4;  // every fourth picture, or block of a single one
constexpr int BLOCK = 16;            // [pixels]

std::map<std::string, fs::path> pictures_in(const fs::path& folder) {
  if (!fs::is_directory(folder)) throw UsageError(folder.string() + ": there is no such folder of pictures");
  std::map<std::string, fs::path> pictures;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    const std::string suffix = entry.path().extension().string();
    if (suffix == ".png" || suffix == ".jpg" || suffix == ".jpeg")
      pictures[entry.path().stem().string()] = entry.path();
  }
  return pictures;
}

std::vector<float> linear(const Picture8& picture) {
  std::vector<float> values(picture.rgb.size());
  std::transform(picture.rgb.begin(), picture.rgb.end(), values.begin(),
                 [](std::uint8_t byte) { return srgb_to_linear(float(byte) / 255.0f); });
  return values;
}

std::vector<float> coded(std::vector<float> values) {
  for (float& v : values) v = linear_to_srgb(std::clamp(v, 0.0f, 1.0f));
  return values;
}

std::vector<PicturePair> read_pairs(const fs::path& rendered_folder, const fs::path& real_folder) {
  const auto rendered = pictures_in(rendered_folder), real = pictures_in(real_folder);
  std::vector<PicturePair> pairs;
  for (const auto& [name, file] : rendered) {
    const auto partner = real.find(name);
    if (partner == real.end()) continue;
    const Picture8 a = read_picture(file), b = read_picture(partner->second);
    if (a.width != b.width || a.height != b.height)
      throw UsageError(file.string() + " has " + std::to_string(a.width) + " x " + std::to_string(a.height) +
                       " pixels, " + partner->second.string() + " " + std::to_string(b.width) + " x " +
                       std::to_string(b.height) + "; render at the size of the real pictures");
    pairs.push_back({a.width, a.height, linear(a), linear(b)});
  }
  if (pairs.empty())
    throw UsageError("no picture in " + rendered_folder.string() + " has the name of one in " + real_folder.string() +
                     "; pairs are found by their names, such as front_000000.png");
  return pairs;
}

// which pixels are kept back to judge the table by: of whole pictures, or of blocks where there is one picture only
std::vector<std::vector<bool>> held_out_pixels(const std::vector<PicturePair>& pairs) {
  std::vector<std::vector<bool>> held;
  for (std::size_t p = 0; p < pairs.size(); ++p) {
    const PicturePair& pair = pairs[p];
    std::vector<bool> is_held(std::size_t(pair.width) * std::size_t(pair.height), p % HELD_OUT == HELD_OUT - 1);
    if (pairs.size() < HELD_OUT)
      for (std::size_t i = 0; i < is_held.size(); ++i) {
        const std::size_t x = i % std::size_t(pair.width) / BLOCK, y = i / std::size_t(pair.width) / BLOCK;
        is_held[i] = (x + 2 * y) % HELD_OUT == 0;
      }
    held.push_back(std::move(is_held));
  }
  return held;
}

struct Quality {
  double psnr_before = 0, psnr_after = 0;  // of held-out pixels [dB]
  double ssim_before = 0, ssim_after = 0;  // of whole pictures that were held out; of all where there are blocks
};

Quality judge(const std::vector<PicturePair>& pairs, const std::vector<std::vector<bool>>& held, const Lut& lut) {
  std::vector<float> before, after, truth;
  Quality quality;
  std::size_t n = 0;
  for (std::size_t p = 0; p < pairs.size(); ++p) {
    std::vector<float> mapped = pairs[p].rendered;
    apply_lut(lut, mapped);
    const std::vector<float> a = coded(pairs[p].rendered), b = coded(mapped), t = coded(pairs[p].real);
    bool any = false;
    for (std::size_t i = 0; i < t.size(); ++i) {
      if (!held[p][i / 3]) continue;
      any = true;
      before.push_back(a[i]);
      after.push_back(b[i]);
      truth.push_back(t[i]);
    }
    if (!any) continue;
    ++n;
    quality.ssim_before += ssim(a, t, pairs[p].width, pairs[p].height);
    quality.ssim_after += ssim(b, t, pairs[p].width, pairs[p].height);
  }
  quality.psnr_before = psnr(before, truth);
  quality.psnr_after = psnr(after, truth);
  quality.ssim_before /= double(n);
  quality.ssim_after /= double(n);
  return quality;
}

std::string shown_psnr(double psnr) {
  return std::isfinite(psnr) ? fmt::format("{:.2f} dB", psnr) : "without bound (equal colours)";
}

void run_calibrate_lut(const CalibrateLutOptions& options) {
  if (options.rendered.empty() || options.real.empty() || options.output.empty())
    throw UsageError("calibrate lut needs --render DIR, --real DIR and -o FILE.csv");
  check_output_file(options.output, {".csv"});
  const std::vector<PicturePair> pairs = read_pairs(options.rendered, options.real);
  const std::vector<std::vector<bool>> held = held_out_pixels(pairs);
  std::vector<std::vector<bool>> uses;
  std::size_t n_used = 0, n_all = 0;
  for (std::size_t p = 0; p < pairs.size(); ++p) {
    std::vector<bool> use = valid_pixels(pairs[p]);
    for (std::size_t i = 0; i < use.size(); ++i) {
      use[i] = use[i] && !held[p][i];
      n_used += use[i];
    }
    n_all += use.size();
    uses.push_back(std::move(use));
  }
  const Lut lut = fit_lut(pairs, uses);
  const Quality quality = judge(pairs, held, lut);
  write_lut(options.output, lut);
  if (options.as_json) {
    const nlohmann::ordered_json out = {{"schema", 1},
                                        {"pairs", pairs.size()},
                                        {"pixels", n_all},
                                        {"pixels_used", n_used},
                                        {"psnr_before", quality.psnr_before},
                                        {"psnr_after", quality.psnr_after},
                                        {"ssim_before", quality.ssim_before},
                                        {"ssim_after", quality.ssim_after}};
    std::printf("%s\n", out.dump(2).c_str());
    return;
  }
  std::printf("%s, %.1f %% of the pixels used; held out: PSNR %s -> %s, SSIM %.4f -> %.4f\n",
              counted(pairs.size(), "pair").c_str(), 100.0 * double(n_used) / double(n_all),
              shown_psnr(quality.psnr_before).c_str(), shown_psnr(quality.psnr_after).c_str(), quality.ssim_before,
              quality.ssim_after);
}

}  // namespace

void add_calibrate_lut(CLI::App& program) {
  CLI::App* command =
      command_group(program, "calibrate")
          .add_subcommand("lut", "A lookup table per channel from rendered to recorded colours of the same views");
  CalibrateLutOptions& o = options_of_command(*command, run_calibrate_lut);
  command->add_option("--render", o.rendered, "Folder of rendered pictures (PNG, JPEG)");
  command->add_option("--real", o.real, "Folder of the real ones; pairs have the same name");
  command->add_option("-o,--output", o.output, "Table to write (.csv)");
  command->add_flag("--json", o.as_json, "Print JSON");
  command->footer(
      "A quarter of the pictures, or of the blocks of fewer than four, is held out to judge the table by.\n"
      "Example:\n  phyvisgen calibrate lut --render out/front --real photos -o lut.csv");
}

}  // namespace pvg
