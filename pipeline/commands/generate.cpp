// phyvisgen generate: episodes of a task, simulated, rendered and recorded into a folder.
#include <algorithm>
#include <charconv>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "host/base/atomic_files.hpp"
#include "host/base/files.hpp"
#include "host/base/progress.hpp"
#include "host/base/stop_signal.hpp"
#include "host/device/choose_device.hpp"
#include "host/formats/video.hpp"
#include "host/load/build_scene.hpp"
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
  std::string worlds = "1";  // episodes that step together
};

constexpr std::chrono::seconds BETWEEN_SUMMARIES(5);  // writings of set.json
constexpr std::size_t MOST_WORLDS = 1024;             // threads of the stage graphs
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

// The episodes under way in one line: their frames together.
class FramesUnderWay {
 public:
  explicit FramesUnderWay(Progress& progress) : progress_(progress) {}
  void begin(std::uint64_t episode, std::size_t n_frames) {
    const std::lock_guard lock(mutex_);
    frames_[episode] = {0, n_frames};
    show_anew();
  }
  void advance(std::uint64_t episode, std::size_t done) {
    const std::lock_guard lock(mutex_);
    frames_[episode].done = done;
    progress_.advance_to(sum().done);
  }
  void end(std::uint64_t episode) {
    const std::lock_guard lock(mutex_);
    frames_.erase(episode);
    if (!frames_.empty()) show_anew();
  }

 private:
  struct Frames {
    std::size_t done = 0, total = 0;
  };
  Frames sum() const {
    Frames all;
    for (const auto& [episode, frames] : frames_) {
      all.done += frames.done;
      all.total += frames.total;
    }
    return all;
  }
  void show_anew() {
    std::string label = frames_.size() == 1 ? "episode" : "episodes";
    for (const auto& [episode, frames] : frames_)
      label += (label.back() == 's' || label.back() == 'e' ? " " : ", ") + std::to_string(episode);
    const Frames all = sum();
    progress_.begin(label, all.total, all.done);
  }
  std::mutex mutex_;
  std::map<std::uint64_t, Frames> frames_;
  Progress& progress_;
};

// One call of `generate`: what the threads that make its episodes share.
struct Run {
  const GenerateOptions& options;
  const Task& task;
  const EpisodeSet& set;
  const Shard shard;
  EpisodeDevices& devices;
  const std::atomic<bool>& stop;

  std::mutex mutex;                                            // of what follows
  std::uint64_t next;                                          // episode to look at
  std::vector<std::pair<std::uint64_t, std::string>> reasons;  // of episodes that failed
  std::exception_ptr error;                                    // that ends the run

  std::chrono::steady_clock::time_point last_summary;  // when set.json was written

  std::mutex counting;  // of the set's progress, which the lines of the terminal ask for at any time
  SetProgress progress;
  const std::chrono::steady_clock::time_point start = std::chrono::steady_clock::now();
  Progress line{"episode", "frames", 0};
  FramesUnderWay frames{line};

  bool is_ending() {
    const std::lock_guard lock(mutex);
    return error != nullptr;
  }
  std::string set_line(int bar_width) {
    const std::lock_guard lock(counting);
    progress.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return set_progress_line(progress, bar_width);
  }
  void count(std::size_t SetProgress::*made) {
    const std::lock_guard lock(counting);
    ++(progress.*made);
  }
};

std::string failure_sentence(std::uint64_t episode, const std::string& reason) {
  return "episode " + std::to_string(episode) + " failed: " + reason;
}

// The next episode that is neither done nor known to fail; nothing once the run ends.
std::optional<std::uint64_t> next_episode(Run& run) {
  const std::lock_guard lock(run.mutex);
  while (!run.error && run.next < run.options.n_episodes) {
    const std::uint64_t episode = run.next;
    run.next += run.shard.count;
    if (is_done(run.set, episode)) {
      run.count(&SetProgress::done_before);
      continue;
    }
    if (const auto known = failure_of(run.set.folder, episode); known && !run.options.retries_failed) {
      run.reasons.emplace_back(episode, failure_sentence(episode, *known));
      run.count(&SetProgress::failed_before);
      continue;
    }
    if (run.stop)
      run.error = std::make_exception_ptr(TryAgain(STOPPED));
    else
      return episode;
  }
  return std::nullopt;
}

// Puts an episode's folder in its place: complete, or under failed/ with the reason.
void put_in_place(const Run& run, const EpisodeReport& report, const std::string& summary, PartialFolder& folder,
                  std::uint64_t episode) {
  const fs::path failed = failed_folder(run.set.folder, episode);
  if (report.has_succeeded) {
    write_text_atomically(folder.path() / "summary.json", summary);
    folder.finish();
    std::error_code ignored;
    fs::remove_all(failed, ignored);
    return;
  }
  fs::create_directories(failed.parent_path());
  PartialFolder kept(failed);
  if (run.options.keep_failed)
    for (const fs::directory_entry& entry : fs::directory_iterator(folder.path()))
      fs::rename(entry.path(), kept.path() / entry.path().filename());
  write_text_atomically(kept.path() / "summary.json", summary);
  kept.finish();
}

void make_episode(Run& run, std::uint64_t episode) {
  EpisodeSettings settings;
  settings.seed = run.options.seed;
  settings.episode = episode;
  settings.renders = !run.options.no_render;
  settings.frames_under_way = run.options.frames_under_way;
  PartialFolder folder(episode_folder(run.set.folder, episode));
  run.frames.begin(episode, 0);
  const EpisodeReport report =
      run_episode(run.task, settings, run.devices, folder.path(), run.stop, [&](std::size_t done, std::size_t total) {
        if (run.is_ending()) throw TryAgain(STOPPED);
        if (done == 0) run.frames.begin(episode, total);
        run.frames.advance(episode, done);
      });
  run.frames.end(episode);
  // a signal to the whole group ends a mesh's reader, too: that is no failure of the episode
  if (!report.has_succeeded && run.stop) throw TryAgain(STOPPED);
  const std::string summary = summary_json(run.task, settings, report);
  const std::lock_guard lock(run.mutex);
  if (run.options.is_verbose) {
    run.line.clear();
    if (run.options.worlds != "1") std::fprintf(stderr, "episode %llu\n", static_cast<unsigned long long>(episode));
    explain(report);
  }
  put_in_place(run, report, summary, folder, episode);
  if (!report.has_succeeded) run.reasons.emplace_back(episode, failure_sentence(episode, report.reason));
  // it looks at every episode of the folder: not after each of thousands
  if (const auto now = std::chrono::steady_clock::now(); now - run.last_summary > BETWEEN_SUMMARIES) {
    write_set(run.set);
    run.last_summary = now;
  }
  run.count(report.has_succeeded ? &SetProgress::done : &SetProgress::failed);
  // on a terminal it stands above the next episode's
  if (run.progress.total > 1 && (!shows_on_terminal() || run.progress.left() == 0)) {
    run.line.clear();
    std::fprintf(stderr, "%s\n", run.set_line(0).c_str());
  }
}

void make_episodes(Run& run) {
  try {
    while (const auto episode = next_episode(run)) make_episode(run, *episode);
  } catch (const std::exception&) {
    const std::lock_guard lock(run.mutex);
    // whatever went wrong after a stop, such as that its folder is gone, is of the stop
    if (!run.error) run.error = run.stop ? std::make_exception_ptr(TryAgain(STOPPED)) : std::current_exception();
  }
}

// How many episodes step together.
std::size_t n_worlds(const GenerateOptions& options, const Task& task, EpisodeDevices& devices, std::uint64_t first) {
  std::size_t n = 0;
  const char *begin = options.worlds.data(), *end = begin + options.worlds.size();
  if (const auto parsed = std::from_chars(begin, end, n);
      parsed.ec == std::errc() && parsed.ptr == end && n >= 1 && n <= MOST_WORLDS)
    return n;
  if (options.worlds != "automatic")
    throw UsageError("--worlds " + options.worlds + " is neither automatic nor a number from 1 to " +
                     std::to_string(MOST_WORLDS));
  // rendering fills a device by itself
  if (!options.no_render) return 1;
  try {
    const TaskScene built = build_scene(task, options.seed, first);
    devices.simulation.join(built.scene);
  } catch (const DeviceError&) {
    throw;
  } catch (const UsageError&) {  // a start that is no good: the episode will say so
  }
  return automatic_worlds(devices.simulation.device().info(), devices.simulation.device().peak_bytes());
}

void report_end(Run& run) {
  std::sort(run.reasons.begin(), run.reasons.end());
  const auto& reasons = run.reasons;
  if (run.options.as_json)
    std::printf("%s", status_json(run.set).c_str());
  else
    std::printf("%s: %llu made, %llu there before, %zu failed\n", run.set.folder.c_str(),
                static_cast<unsigned long long>(run.progress.done),
                static_cast<unsigned long long>(run.progress.done_before), reasons.size());
  if (reasons.size() == 1) throw Failure(reasons.front().second);
  if (!reasons.empty())
    throw Failure(std::to_string(reasons.size()) + " of " + std::to_string(reasons.size() + run.progress.done) +
                  " episodes failed, the first: " + reasons.front().second + "; " +
                  (run.set.folder / "set.json").string() + " names all");
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

  EpisodeDevices devices(physics, rendering);
  Run run{options, task, set, shard, devices, stop, {}, shard.index, {}, {}, {}, {}, {}};
  run.progress.total = (options.n_episodes + shard.count - 1 - shard.index) / shard.count;
  if (run.progress.total > 1) run.line.set_line_above([&](int bar_width) { return run.set_line(bar_width); });
  const std::size_t n =
      std::min(n_worlds(options, task, devices, shard.index), std::max<std::size_t>(run.progress.total, 1));
  if (n == 1) {
    make_episodes(run);
  } else {
    std::vector<std::thread> threads;
    for (std::size_t i = 0; i < n; ++i) threads.emplace_back([&] { make_episodes(run); });
    for (std::thread& thread : threads) thread.join();
  }
  if (run.error) {
    write_set_if_possible(set);
    if (!was_there) remove_empty(set);
    std::rethrow_exception(run.error);
  }
  write_set(set);
  report_end(run);
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
      ->add_option("--worlds", o.worlds, "Episodes that are simulated together, or automatic; no result depends on it")
      ->capture_default_str();
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
