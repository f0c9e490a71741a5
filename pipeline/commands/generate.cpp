// phyvisgen generate: episodes of a task, simulated, rendered and recorded into a folder.
#include <algorithm>
#include <charconv>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <optional>
#include <string>

#include "host/base/atomic_files.hpp"
#include "host/base/files.hpp"
#include "host/base/progress.hpp"
#include "host/base/stop_signal.hpp"
#include "host/device/choose_device.hpp"
#include "host/formats/video.hpp"
#include "host/load/task_file.hpp"
#include "pipeline/command_line/command.hpp"
#include "pipeline/episode/episode.hpp"
#include "pipeline/episode/episode_set.hpp"
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
  std::size_t frames_under_way = 3;  // bound of the stage graph
  bool no_render = false;            // states only
  bool keep_failed = false;          // keep the record of failed episodes
  bool retries_failed = false;       // make failed episodes again
  bool as_json = false, is_verbose = false;
  bool shows_graph = false;  // print the graph and nothing else
  bool is_rigid = false;     // fingers that do not bend
};

constexpr const char* STOPPED = "stopped; the episodes that were finished stay, the same command continues";

struct Shard {
  std::uint64_t index = 0, count = 1;
};

Shard parse_shard(const std::string& text) {
  Shard shard;
  const char *begin = text.data(), *end = begin + text.size();
  const auto first = std::from_chars(begin, end, shard.index);
  bool ok = first.ec == std::errc() && first.ptr != end && *first.ptr == '/';
  if (ok) {
    const auto second = std::from_chars(first.ptr + 1, end, shard.count);
    ok = second.ec == std::errc() && second.ptr == end && shard.index < shard.count;
  }
  if (!ok) throw UsageError("--shard " + text + " is not i/n with i from 0 to n - 1, such as 0/4");
  return shard;
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
                                  (options.is_rigid ? " rigid" : ""));
  set.versions = versions(physics, rendering, !options.no_render && task.render.denoise);
  join_set(set);
  write_set(set);
  return set;
}

// A folder that this run made and nothing came into goes again.
void remove_empty(const EpisodeSet& set) {
  const SetStatus status = read_status(set.folder);
  if (!status.done.empty() || !status.failed.empty()) return;
  std::error_code ignored;
  fs::remove(set.folder / "set.json", ignored);
  fs::remove(set.folder, ignored);
}

void explain(const EpisodeReport& report) {
  for (const MeshSize& mesh : report.meshes)
    std::fprintf(stderr, "  mesh %s: %zu nodes, %zu elements, %zu triangles\n", mesh.name.c_str(), mesh.nodes,
                 mesh.elements, mesh.triangles);
  const SolverTotals& solver = report.solver;
  std::fprintf(
      stderr, "  %lld steps of %g s: %.1f Newton iterations and %.0f of conjugate gradients per step, %lld retries\n",
      static_cast<long long>(solver.steps), report.time_step,
      double(solver.newton) / double(std::max<std::int64_t>(solver.steps, 1)),
      double(solver.cg) / double(std::max<std::int64_t>(solver.steps, 1)), static_cast<long long>(solver.retries));
  for (const auto& [stage, seconds] : report.seconds) std::fprintf(stderr, "  %-10s %7.1f s\n", stage.c_str(), seconds);
}

// Runs one episode; its folder appears when it is complete, or under failed/ with the reason, a sentence.
bool make_episode(const GenerateOptions& options, const Task& task, const EpisodeSet& set, std::uint64_t episode,
                  Device& physics, Device& rendering, const std::atomic<bool>& stop, Progress& frames,
                  std::string& reason) {
  EpisodeSettings settings;
  settings.seed = options.seed;
  settings.episode = episode;
  settings.renders = !options.no_render;
  settings.frames_under_way = options.frames_under_way;
  EpisodeReport report;
  PartialFolder folder(episode_folder(set.folder, episode));
  const std::string label = "episode " + std::to_string(episode);
  frames.begin(label, 0);
  report =
      run_episode(task, settings, physics, rendering, folder.path(), stop, [&](std::size_t done, std::size_t total) {
        if (done == 0) frames.begin(label, total);
        frames.advance_to(done);
      });
  // a signal to the whole group ends a mesh's reader, too: that is no failure of the episode
  if (!report.has_succeeded && stop) throw TryAgain(STOPPED);
  if (options.is_verbose) {
    frames.clear();
    explain(report);
  }
  const std::string summary = summary_json(task, settings, report);
  const fs::path failed = failed_folder(set.folder, episode);
  if (report.has_succeeded) {
    write_text_atomically(folder.path() / "summary.json", summary);
    folder.finish();
    std::error_code ignored;
    fs::remove_all(failed, ignored);
  } else {
    reason = "episode " + std::to_string(episode) + " failed: " + report.reason;
    fs::create_directories(failed.parent_path());
    PartialFolder kept(failed);
    if (options.keep_failed)
      for (const fs::directory_entry& entry : fs::directory_iterator(folder.path()))
        fs::rename(entry.path(), kept.path() / entry.path().filename());
    write_text_atomically(kept.path() / "summary.json", summary);
    kept.finish();
  }
  write_set(set);
  return report.has_succeeded;
}

void run_generate(const GenerateOptions& options) {
  if (options.shows_graph) {
    std::printf("%s", draw(episode_table()).c_str());
    return;
  }
  if (options.task.empty())
    throw UsageError("generate needs a task file; `phyvisgen generate --help` shows an example");
  if (options.folder.empty()) throw UsageError("generate needs an output folder: -o DIR");
  if (options.seed >= EVALUATION_SEEDS)
    throw UsageError("--seed " + std::to_string(options.seed) +
                     " belongs to evaluation: seeds from 2^63 on are none of a training set");
  const Shard shard = parse_shard(options.shard);
  const std::atomic<bool>& stop = stop_on_signals();
  Task task = load_task(options.task);
  apply(options.pictures, task);
  if (options.is_rigid) make_grippers_rigid(task);
  // what would only show after minutes of simulation
  if (!options.no_render) find_program("ffmpeg", "ffmpeg");
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

  std::vector<std::string> reasons;  // of the episodes that failed
  SetProgress progress;
  const auto start = std::chrono::steady_clock::now();
  const auto line = [&](int bar_width) {
    progress.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return set_progress_line(progress, bar_width);
  };
  progress.total = (options.n_episodes + shard.count - 1 - shard.index) / shard.count;
  Progress frames("episode", "frames", 0);
  if (progress.total > 1) frames.set_line_above(line);
  for (std::uint64_t episode = shard.index; episode < options.n_episodes; episode += shard.count) {
    if (is_done(set, episode)) {
      ++progress.done_before;
      continue;
    }
    if (const auto known = failure_of(set.folder, episode); known && !options.retries_failed) {
      reasons.push_back("episode " + std::to_string(episode) + " failed: " + *known);
      ++progress.failed_before;
      continue;
    }
    if (stop) throw TryAgain(STOPPED);
    std::string reason;
    try {
      const bool is_made = make_episode(options, task, set, episode, physics, rendering, stop, frames, reason);
      ++(is_made ? progress.done : progress.failed);
      if (!is_made) reasons.push_back(reason);
      // on a terminal it stands above the next episode's
      if (progress.total > 1 && (!shows_on_terminal() || progress.left() == 0)) {
        frames.clear();
        std::fprintf(stderr, "%s\n", line(0).c_str());
      }
    } catch (const std::exception&) {
      if (!was_there) remove_empty(set);
      if (!stop) throw;
      throw TryAgain(STOPPED);  // whatever went wrong after a stop, such as that its folder is gone, is of the stop
    }
  }
  write_set(set);
  if (options.as_json)
    std::printf("%s", status_json(set).c_str());
  else
    std::printf("%s: %llu made, %llu there before, %zu failed\n", set.folder.c_str(),
                static_cast<unsigned long long>(progress.done), static_cast<unsigned long long>(progress.done_before),
                reasons.size());
  if (reasons.size() == 1) throw Failure(reasons.front());
  if (!reasons.empty())
    throw Failure(std::to_string(reasons.size()) + " of " + std::to_string(reasons.size() + progress.done) +
                  " episodes failed, the first: " + reasons.front() + "; " + (set.folder / "set.json").string() +
                  " names all");
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
  command->add_option("--device", o.device, "OpenCL device: an index, part of its name, cpu or gpu");
  command->add_option("--render-device", o.render_device,
                      "The one that renders, if another; where neither is named: a second GPU of the same kind");
  command->add_option("--width", o.pictures.width, "Width of all pictures [pixels]")->check(CLI::Range(2, 16384));
  command->add_option("--height", o.pictures.height, "Height of all pictures [pixels]")->check(CLI::Range(2, 16384));
  command->add_option("--samples", o.pictures.samples, "Paths per pixel")->check(CLI::Range(1, 1 << 20));
  command->add_option("--fps", o.pictures.frames_per_second, "Frames per second of motion")
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
      "  phyvisgen generate data/tasks/weigh_beaker.yaml --device 0 --render-device 1 -o out/beaker");
}

}  // namespace pvg
