#include "pipeline/episode/make_episodes.hpp"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <mutex>
#include <optional>
#include <thread>

#include "host/base/atomic_files.hpp"
#include "pipeline/episode/frames_under_way.hpp"

namespace pvg {
namespace {

namespace fs = std::filesystem;

constexpr std::chrono::seconds BETWEEN_SUMMARIES(5);  // writings of set.json
constexpr const char* STOPPED = "stopped; the episodes that were finished stay, the same command continues";

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

// What the threads that make the episodes share.
struct SetRun {
  const Task& task;
  const EpisodeSet& set;
  const MakeOptions& options;
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
std::optional<std::uint64_t> next_episode(SetRun& run) {
  const std::lock_guard lock(run.mutex);
  while (!run.error && run.next < run.set.n_asked) {
    const std::uint64_t episode = run.next;
    run.next += run.options.shard.count;
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
void put_in_place(const SetRun& run, const EpisodeReport& report, const std::string& summary, PartialFolder& folder,
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
  if (run.options.keeps_failed)
    for (const fs::directory_entry& entry : fs::directory_iterator(folder.path()))
      fs::rename(entry.path(), kept.path() / entry.path().filename());
  write_text_atomically(kept.path() / "summary.json", summary);
  kept.finish();
}

void make_episode(SetRun& run, std::uint64_t episode, std::size_t simulation) {
  EpisodeSettings settings;
  settings.seed = run.set.seed;
  settings.episode = episode;
  settings.renders = run.options.renders;
  settings.cameras = run.options.cameras;
  settings.frames_under_way = run.options.frames_under_way;
  settings.simulation = simulation;
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
    if (run.options.n_worlds > 1) std::fprintf(stderr, "episode %llu\n", static_cast<unsigned long long>(episode));
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

void make_until_the_end(SetRun& run, std::size_t simulation) {
  try {
    while (const auto episode = next_episode(run)) make_episode(run, *episode, simulation);
  } catch (const std::exception&) {
    const std::lock_guard lock(run.mutex);
    // whatever went wrong after a stop, such as that its folder is gone, is of the stop
    if (!run.error) run.error = run.stop ? std::make_exception_ptr(TryAgain(STOPPED)) : std::current_exception();
  }
}

}  // namespace

MadeEpisodes make_episodes(const Task& task, const EpisodeSet& set, const MakeOptions& options, EpisodeDevices& devices,
                           const std::atomic<bool>& stop) {
  SetRun run{task, set, options, devices, stop, {}, options.shard.index, {}, {}, {}, {}, {}};
  run.progress.total = options.shard.size(set.n_asked);
  if (run.progress.total > 1) run.line.set_line_above([&](int bar_width) { return run.set_line(bar_width); });
  std::vector<std::thread> others;
  for (std::size_t i = 1; i < options.n_worlds; ++i)
    others.emplace_back([&, i] { make_until_the_end(run, i % devices.simulations.size()); });
  make_until_the_end(run, 0);
  for (std::thread& thread : others) thread.join();
  std::sort(run.reasons.begin(), run.reasons.end());
  return {run.progress, run.reasons, run.error};
}

}  // namespace pvg
