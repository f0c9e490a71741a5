// phyvisgen pack: the finished episodes of a set as a data set that imitation learning loads.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "host/base/atomic_files.hpp"
#include "host/base/counted.hpp"
#include "host/base/outputs.hpp"
#include "host/base/progress.hpp"
#include "host/dataset/formats.hpp"
#include "host/formats/video.hpp"
#include "pipeline/command_line/command.hpp"
#include "pipeline/command_line/parquet_python.hpp"
#include "pipeline/episode/episode_set.hpp"

namespace pvg {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

struct PackOptions {
  std::string folder, output;        // of a set, of the data set
  std::string format = "lerobot";    // of data_set_formats()
  std::string instruction;           // what the robot is told to do; empty: the task's name in words
  std::vector<std::string> cameras;  // names; empty: all
  bool has_environment = false;      // poses of objects and keypoints of cloths, too
  bool no_pictures = false;
  bool no_start = false;
};

PackedEpisode read_episode(const PackOptions& options, const fs::path& folder, bool has_start) {
  return options.no_pictures ? read_packed_states(folder, has_start)
                             : read_packed_episode(folder, options.cameras, has_start);
}

// Whether rows begin with the start: all of a set do, or none.
bool begins_at_start(const EpisodeSet& set, const std::vector<std::uint64_t>& episodes, const PackOptions& options) {
  if (options.no_start) return false;
  for (const std::uint64_t episode : episodes) {
    const fs::path folder = episode_folder(set.folder, episode);
    if (options.no_pictures ? has_packed_start_of_states(folder) : has_packed_start(folder, options.cameras)) continue;
    std::fprintf(stderr,
                 "phyvisgen: note: %s lacks its start, as episodes of earlier versions do: all rows begin one period "
                 "after it; generate the set anew for rows from the start on\n",
                 folder.c_str());
    return false;
  }
  return true;
}

std::unique_ptr<ParquetTables> open_parquet() {
  return std::make_unique<ParquetTables>(python_with_pyarrow(), parquet_script("write_parquet.py"));
}

// Where the packed episodes come from.
Json origin_of(const EpisodeSet& set, const std::vector<std::uint64_t>& episodes, bool has_start) {
  Json versions = Json::object();
  for (const auto& [name, version] : set.versions) versions[name] = version;
  return {{"schema", 1},
          {"task", set.task},
          {"seed", set.seed},
          {"configuration", set.configuration},
          {"versions", versions},
          {"episodes", episodes},
          {"first_row", has_start ? "the start, before the first step" : "one period after the start"},
          {"state", "of the joints [rad], of grippers the width [m], at the end of the step that the picture shows"},
          {"action",
           "absolute targets [rad, m] applied in the step that the next picture shows; in the last row those "
           "of the last step"}};
}

PackedSet survey(const EpisodeSet& set, const std::vector<std::uint64_t>& episodes, const PackOptions& options,
                 bool has_start) {
  PackedSet all;
  const PackedEpisode first = read_episode(options, episode_folder(set.folder, episodes.front()), has_start);
  for (const std::uint64_t episode : episodes)
    add(all, first, read_episode(options, episode_folder(set.folder, episode), has_start));
  if (std::abs(first.frames_per_second - std::round(first.frames_per_second)) > 1e-9)
    throw UsageError(set.folder.string() + " has " + std::to_string(first.frames_per_second) +
                     " pictures per second; data sets need a whole number");
  return all;
}

void run_pack(const PackOptions& options) {
  if (options.folder.empty())
    throw UsageError("pack needs the folder of a set; `phyvisgen pack --help` shows an example");
  if (options.output.empty()) throw UsageError("pack needs an output folder: -o OUT");
  if ((options.has_environment || options.no_pictures || !options.instruction.empty()) &&
      !data_set_format(options.format).holds_states)
    throw UsageError(
        "--environment-state, --no-pictures and --instruction need a format that holds them: --format lerobot or "
        "lerobot2");
  if (options.no_pictures && !options.cameras.empty())
    throw UsageError("--no-pictures leaves out the cameras that --camera names; give one of the two");
  for (const std::string& name : options.cameras)
    if (std::count(options.cameras.begin(), options.cameras.end(), name) > 1)
      throw UsageError("--camera " + name + " stands there twice; name it once");
  check_apart(options.output, options.folder, "pack");
  if (fs::exists(options.output))
    throw UsageError(options.output + " exists; remove it or choose another folder with -o");
  const EpisodeSet set = read_set(options.folder);
  const std::vector<std::uint64_t> episodes = read_status(set.folder).done;
  if (episodes.empty()) throw UsageError(set.folder.string() + " has no finished episode to pack");
  find_program("ffmpeg", "ffmpeg");
  const bool has_start = begins_at_start(set, episodes, options);
  const PackedSet all = survey(set, episodes, options, has_start);

  const fs::path output = fs::absolute(options.output).lexically_normal();
  const fs::path target = output.has_filename() ? output : output.parent_path();
  make_writable_folder(target.parent_path());
  remove_leftovers(target.parent_path());
  PartialFolder folder(target);
  std::unique_ptr<ParquetTables> parquet;
  const auto tables = [&]() -> ParquetTables& {
    if (!parquet) parquet = open_parquet();
    return *parquet;
  };
  const std::unique_ptr<DataSetWriter> writer =
      data_set_format(options.format)
          .make_writer({folder.path(), all, options.instruction, origin_of(set, episodes, has_start),
                        options.has_environment, tables});
  {
    Progress progress("pack", "episodes", episodes.size());
    for (std::size_t i = 0; i < episodes.size(); ++i) {
      writer->add(read_episode(options, episode_folder(set.folder, episodes[i]), has_start));
      progress.advance_to(i + 1);
    }
  }
  writer->finish();
  if (parquet) parquet->finish();
  folder.finish();
  std::printf("%s: %s, %s\n", target.c_str(), counted(all.n_episodes, "episode").c_str(),
              counted(all.n_frames, "frame").c_str());
}

}  // namespace

void add_pack(CLI::App& program) {
  CLI::App* command = program.add_subcommand("pack", "Make a data set for imitation learning of an episode set");
  PackOptions& o = options_of_command(*command, run_pack);
  command->add_option("DIR", o.folder, "Folder of the set; its finished episodes are packed");
  std::vector<std::string> names;
  std::string help;
  for (const DataSetFormat& format : data_set_formats()) {
    names.push_back(format.name);
    help += (help.empty() ? "" : ", ") + std::string(format.name) + " (" + format.meaning + ")";
  }
  command->add_option("--format", o.format, help)->check(CLI::IsMember(names))->capture_default_str();
  command->add_option("-o,--output", o.output, "Folder to make");
  command->add_option("--camera", o.cameras, "Only this camera; may stand several times")->allow_extra_args(false);
  command->add_flag(
      "--environment-state", o.has_environment,
      "Write observation.environment_state, too: position and quaternion of each object, keypoints of each cloth");
  command->add_flag("--no-pictures", o.no_pictures, "Pack joints alone; the set may be made with --no-render");
  command->add_flag("--no-start", o.no_start,
                    "Leave out the first row, which shows the start: rows begin one period after it");
  command->add_option("--instruction", o.instruction, "What the robot is told to do; else the task's name in words");
  command->footer(
      "Example:\n  phyvisgen pack out/beaker --format lerobot -o out/beaker_lerobot\n"
      "  phyvisgen pack out/beaker --no-pictures --environment-state -o out/beaker_states\n"
      "  phyvisgen pack out/beaker --no-start -o out/beaker_later");
}

}  // namespace pvg
