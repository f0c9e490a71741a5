// phyvisgen evaluate fidelity: pictures and masks of a simulation against those of reality.
#include <cstdio>
#include <string>
#include <vector>

#include "host/base/counted.hpp"
#include "host/base/outputs.hpp"
#include "host/formats/lut_file.hpp"
#include "pipeline/command_line/command.hpp"
#include "pipeline/episode/fidelity.hpp"
#include "pipeline/episode/shown_scene.hpp"

namespace pvg {
namespace {

struct FidelityOptions {
  std::string real, simulated;         // folders
  std::string output;                  // folder of the report; empty: none
  std::vector<std::string> baselines;  // NAME=FOLDER
  std::string lut, frames;
  std::size_t stretch = 10, n_shown = 12;
  bool as_json = false;
};

void print(const std::string& name, const Fidelity& fidelity) {
  for (const auto& [part, overlap] : fidelity.overlap)
    std::printf("%s: mean IoU of %s %.2f %% (95 %%: %.2f to %.2f), %s\n", name.c_str(), part.c_str(),
                100 * overlap.mean, 100 * overlap.low, 100 * overlap.high,
                counted(fidelity.n_masks.at(part), "frame").c_str());
  if (fidelity.psnr)
    std::printf("%s: PSNR %.2f dB (%.2f to %.2f), SSIM %.4f (%.4f to %.4f), %s\n", name.c_str(), fidelity.psnr->mean,
                fidelity.psnr->low, fidelity.psnr->high, fidelity.ssim->mean, fidelity.ssim->low, fidelity.ssim->high,
                counted(fidelity.n_pictures, "picture").c_str());
  if (fidelity.lut_psnr)
    std::printf("%s with LUT: PSNR %.2f dB, SSIM %.4f\n", name.c_str(), fidelity.lut_psnr->mean,
                fidelity.lut_ssim->mean);
}

void run_fidelity(const FidelityOptions& options) {
  if (options.real.empty() || options.simulated.empty())
    throw UsageError("evaluate fidelity needs two folders, REAL and SIM; --help shows an example");
  if (!options.output.empty())
    for (const std::string& read : {options.real, options.simulated})
      check_not_within(options.output, read, "evaluate fidelity");
  const SeenFolder real = read_seen_folder(options.real), simulated = read_seen_folder(options.simulated);
  FidelitySettings settings;
  settings.stretch = options.stretch;
  if (!options.frames.empty()) {
    const std::size_t n = compare(real, simulated, {}).frames.size();
    const FrameRange range = parse_frames(options.frames, n);
    settings.first = range.begin;
    settings.last = range.end;
  }
  if (!options.lut.empty()) settings.lut = read_lut(options.lut);
  const Fidelity fidelity = compare(real, simulated, settings);
  std::map<std::string, Fidelity> baselines;
  for (const std::string& text : options.baselines) {
    const std::size_t at = text.find('=');
    if (at == 0 || at == std::string::npos || at + 1 == text.size())
      throw UsageError("--baseline " + text + " is not NAME=FOLDER, such as rigid=out/rigid/episode_000000");
    baselines[text.substr(0, at)] = compare(real, read_seen_folder(text.substr(at + 1)), settings);
  }
  if (!options.output.empty())
    write_fidelity_report(options.output, real, simulated, fidelity, baselines, options.n_shown);
  if (options.as_json) {
    std::printf("%s", fidelity_json(fidelity, baselines).c_str());
    return;
  }
  print("simulated", fidelity);
  for (const auto& [name, baseline] : baselines) print(name, baseline);
}

}  // namespace

void add_evaluate_fidelity(CLI::App& program) {
  CLI::App* command = program.get_subcommand("evaluate")
                          ->add_subcommand("fidelity", "Pictures and masks of a simulation against those of reality");
  FidelityOptions& o = options_of_command(*command, run_fidelity);
  command->add_option("REAL", o.real,
                      "Folder with NAME.png and masks/NAME.png, masks/PART/NAME.png or CAMERA_masks.h5");
  command->add_option("SIM", o.simulated, "The same of the simulation; pairs have the same name");
  command->add_option("-o,--output", o.output, "Folder of the report: index.html, report.json, overlays, error maps");
  command->add_option("--baseline", o.baselines, "NAME=FOLDER, another simulation of the same frames; repeatable")
      ->allow_extra_args(false);
  command->add_option("--lut", o.lut, "Table of `calibrate lut`: numbers with and without it");
  command->add_option("--frames", o.frames, "A:B, the common frames A to B - 1, such as those of the grasp");
  command->add_option("--stretch", o.stretch, "Frames that the bootstrap keeps together")
      ->check(CLI::Range(1, 1000000))
      ->capture_default_str();
  command->add_option("--shown", o.n_shown, "At most so many frames on the page")
      ->check(CLI::Range(0, 10000))
      ->capture_default_str();
  command->add_flag("--json", o.as_json, "Print JSON");
  command->footer(
      "The fingers that do not bend, against masks of the soft ones:\n"
      "  phyvisgen generate data/tasks/weigh_beaker.yaml -n 1 --gripper rigid -o out/rigid\n"
      "A captured room that is lit again, or takes no shadows:\n"
      "  phyvisgen render data/tasks/weigh_beaker.yaml --states out/demo/episode_000000/states.h5 \\\n"
      "      --receivers relit -o out/relit        (or emissive)\n"
      "Example:\n  phyvisgen evaluate fidelity real out/demo/episode_000000 \\\n"
      "      --baseline rigid=out/rigid/episode_000000 -o out/fidelity");
}

}  // namespace pvg
