// The episodes of a set that are not there yet: several threads take one after the other, and each puts what it made in
// its place. What is finished stays, whatever happens later.
#pragma once
#include <atomic>
#include <cstdint>
#include <exception>
#include <string>
#include <utility>
#include <vector>

#include "host/base/progress.hpp"
#include "pipeline/episode/episode.hpp"
#include "pipeline/episode/episode_set.hpp"

namespace pvg {

// every `count`-th episode, from `index` on
struct Shard {
  std::uint64_t index = 0, count = 1;
  std::uint64_t size(std::uint64_t n_episodes) const { return (n_episodes + count - 1 - index) / count; }
};

struct MakeOptions {
  Shard shard;
  std::size_t n_worlds = 1;          // episodes that are simulated at the same time
  std::size_t frames_under_way = 3;  // bound of each stage graph
  bool renders = true;               // else states only
  std::vector<std::string> cameras;  // whose pictures are rendered; empty: all of the task
  bool keeps_failed = false;         // the record of failed episodes
  bool retries_failed = false;       // makes failed episodes again
  bool is_verbose = false;
};

struct MadeEpisodes {
  SetProgress progress;
  std::vector<std::pair<std::uint64_t, std::string>> reasons;  // of episodes that failed, ascending
  std::exception_ptr error;                                    // that ended the run, such as a stop (TryAgain)
};

MadeEpisodes make_episodes(const Task& task, const EpisodeSet& set, const MakeOptions& options, EpisodeDevices& devices,
                           const std::atomic<bool>& stop);

}  // namespace pvg
