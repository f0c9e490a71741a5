#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "host/base/atomic_files.hpp"
#include "host/base/progress.hpp"
#include "host/dataset/act_files.hpp"
#include "host/dataset/lerobot_dataset.hpp"
#include "host/dataset/robomimic_file.hpp"
#include "host/dataset/umi_zarr.hpp"
#include "host/formats/video.hpp"
#include "pipeline/commands/commands.hpp"
#include "pipeline/commands/data_folder.hpp"
#include "pipeline/episode/episode_set.hpp"

namespace pvg {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

// $PVG_PYTHON, or the environment that scripts/install_pack.sh makes.
fs::path python_with_pyarrow() {
  if (const char* named = std::getenv("PVG_PYTHON")) return named;
  const fs::path python = data_folder().parent_path() / ".venv-pack/bin/python";
  if (fs::exists(python)) return python;
  throw UsageError(
      "LeRobot's formats need Python with pyarrow: run scripts/install_pack.sh, or name an interpreter in "
      "the variable PVG_PYTHON");
}

std::unique_ptr<ParquetTables> open_parquet() {
  return std::make_unique<ParquetTables>(python_with_pyarrow(),
                                         data_folder().parent_path() / "scripts/write_parquet.py");
}

// Where the packed episodes come from.
Json origin_of(const EpisodeSet& set, const std::vector<std::uint64_t>& episodes) {
  Json versions = Json::object();
  for (const auto& [name, version] : set.versions) versions[name] = version;
  return {{"schema", 1},
          {"task", set.task},
          {"seed", set.seed},
          {"configuration", set.configuration},
          {"versions", versions},
          {"episodes", episodes},
          {"state", "of the joints [rad], of grippers the width [m], at the end of the step that the picture shows"},
          {"action",
           "absolute targets [rad, m] applied in the step that the next picture shows; in the last row those "
           "of the last step"}};
}

PackedSet survey(const EpisodeSet& set, const std::vector<std::uint64_t>& episodes,
                 const std::vector<std::string>& cameras) {
  PackedSet all;
  const PackedEpisode first = read_packed_episode(episode_folder(set.folder, episodes.front()), cameras);
  for (const std::uint64_t episode : episodes)
    add(all, first, read_packed_episode(episode_folder(set.folder, episode), cameras));
  if (std::abs(first.frames_per_second - std::round(first.frames_per_second)) > 1e-9)
    throw UsageError(set.folder.string() + " has " + std::to_string(first.frames_per_second) +
                     " pictures per second; data sets need a whole number");
  return all;
}

}  // namespace

void run_pack(const PackOptions& options) {
  if (options.folder.empty())
    throw UsageError("pack needs the folder of a set; `phyvisgen pack --help` shows an example");
  if (options.output.empty()) throw UsageError("pack needs an output folder: -o OUT");
  if (fs::exists(options.output))
    throw UsageError(options.output + " exists; remove it or choose another folder with -o");
  const EpisodeSet set = read_set(options.folder);
  const std::vector<std::uint64_t> episodes = read_status(set.folder).done;
  if (episodes.empty()) throw UsageError(set.folder.string() + " has no finished episode to pack");
  find_program("ffmpeg", "ffmpeg");
  const PackedSet all = survey(set, episodes, options.cameras);

  const fs::path output = fs::absolute(options.output).lexically_normal();
  const fs::path target = output.has_filename() ? output : output.parent_path();
  make_writable_folder(target.parent_path());
  remove_leftovers(target.parent_path());
  PartialFolder folder(target);
  std::unique_ptr<ParquetTables> parquet;
  std::unique_ptr<DataSetWriter> writer;
  if (options.format == "act") writer = make_act_writer(folder.path(), all.most_frames);
  if (options.format == "robomimic") writer = make_robomimic_writer(folder.path(), all);
  if (options.format == "zarr") writer = make_umi_zarr_writer(folder.path());
  if (options.format.starts_with("lerobot")) {
    parquet = open_parquet();
    const LeRobotVersion version = options.format == "lerobot" ? LeRobotVersion::v3_0 : LeRobotVersion::v2_1;
    writer = make_lerobot_writer(folder.path(), {version, options.instruction, origin_of(set, episodes)},
                                 [&](const ParquetTable& table) { parquet->write(table); });
  }
  if (!writer)
    throw UsageError("--format " + options.format + " is not one of lerobot, lerobot2, act, robomimic, zarr");
  {
    Progress progress("pack", "episodes", episodes.size());
    for (std::size_t i = 0; i < episodes.size(); ++i) {
      writer->add(read_packed_episode(episode_folder(set.folder, episodes[i]), options.cameras));
      progress.advance_to(i + 1);
    }
  }
  writer->finish();
  if (parquet) parquet->finish();
  folder.finish();
  std::printf("%s: %zu episodes, %zu frames\n", target.c_str(), all.n_episodes, all.n_frames);
}

}  // namespace pvg
