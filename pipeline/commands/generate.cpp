// phyvisgen generate: episodes of a task, simulated, rendered and recorded into a folder.
#include <algorithm>
#include <charconv>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "host/base/atomic_files.hpp"
#include "host/base/counted.hpp"
#include "host/base/files.hpp"
#include "host/base/stop_signal.hpp"
#include "host/device/choose_device.hpp"
#include "host/formats/video.hpp"
#include "host/load/build_scene.hpp"
#include "host/load/task_file.hpp"
#include "pipeline/command_line/command.hpp"
#include "pipeline/episode/episode_set.hpp"
#include "pipeline/episode/make_episodes.hpp"
#include "pipeline/episode/motion_plan.hpp"

namespace pvg {
namespace {

namespace fs = std::filesystem;

struct GenerateOptions {
  std::string task, folder;  // task file, folder of the set
  std::uint64_t n_episodes = 1, seed = 0;
  std::string shard = "0/1";  // i/n: every n-th episode, from the i-th on
  std::string device;         // as for Device; empty: the best
  std::string render_device;  // empty: a second GPU of the same kind, where neither is named, else `device`
  PictureOverrides pictures;
  std::vector<std::string> cameras;  // names; empty: all
  std::size_t frames_under_way = 3;  // bound of the stage graph
  bool no_render = false;            // states only
  bool keep_failed = false;          // keep the record of failed episodes
  bool retries_failed = false;       // make failed episodes again
  bool as_json = false, is_verbose = false;
  bool shows_graph = false;  // print the graph and nothing else
  bool is_rigid = false;     // fingers that do not bend
  std::string worlds = "1";  // episodes that are simulated at the same time
};

constexpr std::size_t MOST_WORLDS = 1024;  // threads of the stage graphs

Shard parse_shard(const std::string& text) {
  Shard shard;
  const char *begin = text.data(), *end = begin + text.size();
  const auto first = std::from_chars(begin, end, shard.index);
  bool ok = first.ec == std::errc() && first.ptr != end && *first.ptr == '/';
  if (ok) {
    const auto second = std::from_chars(first.ptr + 1, end, shard.count);
    ok = second.ec == std::errc() && second.ptr == end && shard.index < shard.count && shard.count <= MOST_EPISODES;
  }
  if (!ok)
    throw UsageError("--shard " + text + " is not i/n with i from 0 to n - 1 and n at most " +
                     std::to_string(MOST_EPISODES) + ", such as 0/4");
  return shard;
}

void check_cameras(const std::vector<std::string>& cameras, const Task& task) {
  for (const std::string& name : cameras) {
    if (std::count(cameras.begin(), cameras.end(), name) > 1)
      throw UsageError("--camera " + name + " stands there twice; name it once");
    if (std::none_of(task.cameras.begin(), task.cameras.end(), [&](const CameraSection& c) { return c.name == name; }))
      throw UsageError("--camera " + name + " is no camera of " + task.file.string());
  }
}

// Options of pictures that there will be none of: whoever gave them expects pictures.
void check_no_render(const GenerateOptions& options) {
  if (!options.no_render) return;
  if (!options.cameras.empty())
    throw UsageError("--no-render leaves out the cameras that --camera names; give one of the two");
  check_no_pictures(options.pictures, options.render_device);
}

// Before anything is simulated: the videos come last.
void check_sizes(const std::vector<std::string>& cameras, const Task& task) {
  for (const CameraSection& camera : task.cameras)
    if (cameras.empty() || std::find(cameras.begin(), cameras.end(), camera.name) != cameras.end())
      check_video_size("camera " + camera.name + " (--width, --height)", camera.width, camera.height);
}

// each behind a blank
std::string names_of(const std::vector<std::string>& cameras) {
  std::string text;
  for (const std::string& name : cameras) text += " " + name;
  return text;
}

EpisodeSet open_set(const GenerateOptions& options, const Task& task, const Device& physics, const Device& rendering) {
  make_writable_folder(options.folder);
  remove_leftovers(options.folder);
  remove_leftovers(fs::path(options.folder) / "failed");
  EpisodeSet set;
  set.folder = options.folder;
  set.task = task.name;
  set.seed = options.seed;
  set.n_asked = options.n_episodes;
  const PictureOverrides& p = options.pictures;
  set.configuration = fingerprint(read_whole_file(task.file).value_or("") + "\n" + std::to_string(p.width) + " " +
                                  std::to_string(p.height) + " " + std::to_string(p.samples) + " " +
                                  std::to_string(p.frames_per_second) + " " + std::to_string(options.no_render) +
                                  (options.is_rigid ? " rigid" : "") + names_of(options.cameras));
  set.versions = versions(physics, rendering, !options.no_render && task.render.denoise);
  join_set(set);
  write_set(set);
  return set;
}

// A full disk or a folder that is gone has its own message already.
void write_set_if_possible(const EpisodeSet& set) {
  try {
    write_set(set);
  } catch (const std::exception&) {
  }
}

// A folder that this run made and nothing came into goes again.
void remove_empty(const EpisodeSet& set) {
  const SetStatus status = read_status(set.folder);
  if (!status.done.empty() || !status.failed.empty()) return;
  std::error_code ignored;
  fs::remove(set.folder / "set.json", ignored);
  fs::remove(set.folder, ignored);
}

// Of --worlds; none: automatic.
std::optional<std::size_t> parse_worlds(const std::string& text) {
  std::size_t n = 0;
  const char* end = text.data() + text.size();
  if (const auto parsed = std::from_chars(text.data(), end, n);
      parsed.ec == std::errc() && parsed.ptr == end && n >= 1 && n <= MOST_WORLDS)
    return n;
  if (text != "automatic")
    throw UsageError("--worlds " + text + " is neither automatic nor a number from 1 to " +
                     std::to_string(MOST_WORLDS));
  return {};
}

// How many episodes are simulated at the same time.
std::size_t n_worlds(const GenerateOptions& options, const Task& task, Device& physics, std::uint64_t first) {
  if (const auto given = parse_worlds(options.worlds)) return *given;
  // rendering fills a device by itself
  if (!options.no_render) return 1;
  try {
    const TaskScene built = build_scene(task, options.seed, first);
    SharedSimulation(physics).join(built.scene);
  } catch (const DeviceError&) {
    throw;
  } catch (const UsageError&) {  // a start that is no good: the episode will say so
  }
  return automatic_worlds(physics.info(), physics.peak_bytes());
}

// Episodes beside each other take a compute unit each, where the device has several that can be had alone.
EpisodeDevices episode_devices(Device& physics, Device& rendering, std::span<Device> units, std::size_t n_worlds) {
  if (units.empty()) return {physics, rendering};
  return {units.first(std::min(n_worlds, units.size())), rendering};
}

void report_end(const EpisodeSet& set, const MadeEpisodes& made, bool as_json) {
  const auto& reasons = made.reasons;
  if (as_json)
    std::printf("%s", status_json(set).c_str());
  else
    std::printf("%s: %llu made, %llu there before, %zu failed\n", set.folder.c_str(),
                static_cast<unsigned long long>(made.progress.done),
                static_cast<unsigned long long>(made.progress.done_before), reasons.size());
  if (reasons.size() == 1) throw Failure(reasons.front().second);
  if (!reasons.empty())
    throw Failure(std::to_string(reasons.size()) + " of " + counted(reasons.size() + made.progress.done, "episode") +
                  " failed, the first: " + reasons.front().second + "; " + (set.folder / "set.json").string() +
                  " names all");
}

void run_generate(const GenerateOptions& options) {
  check_no_render(options);  // even of --graph, by which submit asks whether options are good
  if (options.shows_graph) {
    std::printf("%s", draw(episode_table()).c_str());
    return;
  }
  if (options.task.empty())
    throw UsageError("generate needs a task file; `phyvisgen generate --help` shows an example");
  if (options.folder.empty()) throw UsageError("generate needs an output folder: -o DIR");
  check_training_seed(options.seed);
  const Shard shard = parse_shard(options.shard);
  parse_worlds(options.worlds);  // before there is a folder
  const std::atomic<bool>& stop = stop_on_signals();
  Task task = load_task(options.task);
  apply(options.pictures, task);
  if (options.is_rigid) make_grippers_rigid(task);
  check_cameras(options.cameras, task);
  // what would only show after minutes of simulation
  if (!options.no_render) {
    find_program("ffmpeg", "ffmpeg");
    check_sizes(options.cameras, task);
  }
  try {
    steps_per_frame(task.render.frames_per_second, task.solver.time_step);
  } catch (const UsageError& error) {
    throw UsageError(task.file.string() + ": " + error.what());
  }
  Device physics(options.device);
  Device rendering(std::to_string(choose_render_device(list_devices(), options.device, options.render_device).index),
                   Purpose::rendering);
  const bool was_there = fs::exists(options.folder);
  const EpisodeSet set = open_set(options, task, physics, rendering);

  MakeOptions make{shard,
                   1,
                   options.frames_under_way,
                   !options.no_render,
                   options.cameras,
                   options.keep_failed,
                   options.retries_failed,
                   options.is_verbose};
  make.n_worlds = std::min<std::size_t>(n_worlds(options, task, physics, shard.index),
                                        std::max<std::uint64_t>(shard.size(options.n_episodes), 1));
  std::vector<Device> units = make.n_worlds > 1 ? physics.compute_units() : std::vector<Device>();
  EpisodeDevices devices = episode_devices(physics, rendering, units, make.n_worlds);
  const MadeEpisodes made = make_episodes(task, set, make, devices, stop);
  if (made.error) {
    write_set_if_possible(set);
    if (!was_there) remove_empty(set);
    std::rethrow_exception(made.error);
  }
  write_set(set);
  report_end(set, made, options.as_json);
}

}  // namespace

void add_generate(CLI::App& program) {
  CLI::App* command = program.add_subcommand("generate", "Simulate, render and record episodes of a task");
  GenerateOptions& o = options_of_command(*command, run_generate);
  command->add_option("TASK", o.task, "Task file (YAML)");
  command->add_option("-n,--episodes", o.n_episodes, "How many episodes the set has")
      ->check(CLI::Range(std::uint64_t(1), MOST_EPISODES))
      ->capture_default_str();
  command->add_option("--seed", o.seed, "Seed of the set; an episode depends on it and on its number alone")
      ->capture_default_str();
  command->add_option("--shard", o.shard, "i/n: make every n-th episode, from the i-th on")->capture_default_str();
  command->add_option("-o,--output", o.folder, "Folder of the set; finished episodes in it are skipped");
  command
      ->add_option("--worlds", o.worlds,
                   "Episodes that are simulated at the same time, or automatic; no result depends on it")
      ->capture_default_str();
  command->add_option("--device", o.device, "OpenCL device: an index, part of its name, cpu or gpu");
  command->add_option("--render-device", o.render_device,
                      "The one that renders, if another; where neither is named: a second GPU of the same kind");
  command->add_option("--camera", o.cameras, "Render this camera only; may stand several times")
      ->allow_extra_args(false);
  command->add_option("--width", o.pictures.width, "Width of all pictures [pixels]")->check(CLI::Range(2, 16384));
  command->add_option("--height", o.pictures.height, "Height of all pictures [pixels]")->check(CLI::Range(2, 16384));
  command->add_option("--samples", o.pictures.samples, "Paths per pixel; else what the task says")
      ->check(CLI::Range(1, 1 << 20));
  command->add_option("--fps", o.pictures.frames_per_second, "Frames per second of motion; else what the task says")
      ->check(CLI::Range(0.01, 1000.0));
  command->add_option("--frames-under-way", o.frames_under_way, "Frames in the stage graph at once")
      ->check(CLI::Range(1, 64))
      ->capture_default_str();
  command->add_flag("--no-render", o.no_render, "Simulate and record states only");
  command->add_flag("--keep-failed", o.keep_failed, "Keep the record of failed episodes in DIR/failed");
  command->add_flag("--retry-failed", o.retries_failed,
                    "Make episodes again that failed before; they fail again unless the program has changed");
  command
      ->add_option_function<std::string>(
          "--gripper", [&o](const std::string& kind) { o.is_rigid = kind == "rigid"; },
          "soft, or rigid: the same fingers without bending, for comparison")
      ->check(CLI::IsMember({"soft", "rigid"}));
  command->add_flag("--graph", o.shows_graph, "Print the graph of the stages (mermaid) and end");
  command->add_flag("--json", o.as_json, "Print the state of the set as JSON at the end");
  command->add_flag("-v,--verbose", o.is_verbose, "Explain: meshes, solver, time per stage");
  command->footer(
      "Exit codes: 0 done, 1 failed, 2 wrong use, 75 stopped before the end: call again to continue.\n"
      "Example:\n  phyvisgen generate data/tasks/weigh_beaker.yaml --episodes 10 --seed 1 -o out/beaker -v\n"
      "  phyvisgen generate data/tasks/weigh_beaker.yaml -n 20 --no-render --worlds automatic -o out/states\n"
      "  phyvisgen generate data/tasks/weigh_beaker.yaml --device 0 --render-device 1 -o out/beaker\n"
      "  phyvisgen generate data/tasks/weigh_beaker.yaml --camera wrist --width 96 --height 96 -o out/wrist");
}

}  // namespace pvg
