// A folder of episodes: which are done, which failed and why. Several processes may fill one folder: everything is
// read off the folder itself, set.json is only its summary.
//   DIR/episode_000000/          done
//   DIR/failed/episode_000001/   failed: summary.json with the reason, and with --keep-failed the record
//   DIR/set.json
#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "host/base/statistics.hpp"

namespace pvg {

inline constexpr std::uint64_t MOST_EPISODES = 1000000000;  // of a set
// Seeds from here on are of starts for the evaluation of policies, so that none is judged on what it was trained on.
inline constexpr std::uint64_t EVALUATION_SEEDS = std::uint64_t(1) << 63;

struct FailedEpisode {
  std::uint64_t episode = 0;
  std::string reason;
};

struct SetStatus {
  std::vector<std::uint64_t> done;    // ascending
  std::vector<FailedEpisode> failed;  // ascending
};

struct EpisodeSet {
  std::filesystem::path folder;
  std::string task;
  std::uint64_t seed = 0;
  std::uint64_t n_asked = 0;
  std::string configuration;  // a fingerprint of everything but the seed that decides what an episode looks like
  std::vector<std::pair<std::string, std::string>> versions;
};

// A UsageError where the seed belongs to evaluation.
void check_training_seed(std::uint64_t seed);

std::filesystem::path episode_folder(const std::filesystem::path& set, std::uint64_t episode);
std::filesystem::path failed_folder(const std::filesystem::path& set, std::uint64_t episode);

// A UsageError where the folder already holds episodes of another task, seed or configuration. What
// counts is how many are asked for last: a slip of a thousand too many does not stay.
void join_set(EpisodeSet& set);

// What set.json says; a UsageError where there is none.
EpisodeSet read_set(const std::filesystem::path& folder);

bool is_done(const EpisodeSet& set, std::uint64_t episode);
// The reason if the episode was made and failed: it would fail again.
std::optional<std::string> failure_of(const std::filesystem::path& set, std::uint64_t episode);
SetStatus read_status(const std::filesystem::path& folder);
void write_set(const EpisodeSet& set);

// Episodes that were asked for and neither done nor failed, ascending; share of the made ones that succeeded (0 of
// none).
std::vector<std::uint64_t> missing(const EpisodeSet& set, const SetStatus& status);
double success_rate(const SetStatus& status);
RateInterval success_interval(const SetStatus& status);

// For --json: the set and its status.
std::string status_json(const EpisodeSet& set);

// 64 bits of FNV-1a as text.
std::string fingerprint(const std::string& text);

}  // namespace pvg
