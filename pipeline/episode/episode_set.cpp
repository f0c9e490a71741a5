#include "pipeline/episode/episode_set.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <ctime>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>

#include "host/base/atomic_files.hpp"
#include "host/base/error.hpp"
#include "host/base/hash.hpp"
#include "host/base/numbers.hpp"
#include "host/dataset/json_file.hpp"

namespace pvg {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr std::string_view PREFIX = "episode_";

std::string episode_name(std::uint64_t episode) { return fmt::format("episode_{:06}", episode); }

std::optional<std::uint64_t> episode_of(const std::string& name) {
  std::uint64_t number = 0;
  if (!name.starts_with(PREFIX)) return std::nullopt;
  const auto parsed = std::from_chars(name.data() + PREFIX.size(), name.data() + name.size(), number);
  if (parsed.ec != std::errc() || parsed.ptr != name.data() + name.size() || name != episode_name(number))
    return std::nullopt;
  return number;
}

std::string utc_now() {
  const std::time_t now = std::time(nullptr);
  std::tm parts{};
  gmtime_r(&now, &parts);
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &parts);
  return text;
}

std::vector<std::uint64_t> episodes_in(const fs::path& folder) {
  std::vector<std::uint64_t> episodes;
  std::error_code ignored;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, ignored))
    if (const auto number = episode_of(entry.path().filename().string())) episodes.push_back(*number);
  std::sort(episodes.begin(), episodes.end());
  return episodes;
}

// What set.json says, checked: counts are loop bounds, names become names of files.
EpisodeSet set_in(const Json& json, const fs::path& path) {
  EpisodeSet set;
  set.task = text_in(json, "task", path);
  set.seed = whole_in(json, "seed", 0, UINT64_MAX, path);
  set.n_asked = whole_in(json, "episodes", 0, MOST_EPISODES, path);
  set.configuration = text_in(json, "configuration", path);
  const Json versions = json.value("versions", Json());
  if (!versions.is_object()) throw UsageError(path.string() + " has a key `versions` that is no mapping");
  for (const auto& entry : versions.items())
    set.versions.emplace_back(entry.key(), text_in(versions, entry.key(), path));
  if (!is_identifier(set.task)) throw UsageError(path.string() + " names a task `" + set.task + "`, which is no name");
  return set;
}

}  // namespace

void check_training_seed(std::uint64_t seed) {
  if (seed >= EVALUATION_SEEDS)
    throw UsageError("--seed " + std::to_string(seed) + " belongs to evaluation: seeds of a training set are 0 to " +
                     std::to_string(EVALUATION_SEEDS - 1));
}

fs::path episode_folder(const fs::path& set, std::uint64_t episode) { return set / episode_name(episode); }
fs::path failed_folder(const fs::path& set, std::uint64_t episode) { return set / "failed" / episode_name(episode); }

void join_set(EpisodeSet& set) {
  const fs::path path = set.folder / "set.json";
  const std::optional<Json> old = read_json_file(path);
  if (!old) return;
  const auto demand = [&](bool is_same, const char* what) {
    if (!is_same)
      throw UsageError(path.string() + ": this folder holds episodes of another " + what +
                       "; choose another folder with -o");
  };
  const EpisodeSet before = set_in(*old, path);
  demand(before.task == set.task, "task");
  demand(before.seed == set.seed, "seed");
  demand(before.configuration == set.configuration, "configuration (the task file or an option differs)");
}

EpisodeSet read_set(const fs::path& folder) {
  const fs::path path = folder / "set.json";
  const std::optional<Json> json = read_json_file(path);
  if (!json) throw UsageError(path.string() + " does not exist; name a folder that generate has filled");
  EpisodeSet set = set_in(*json, path);
  set.folder = folder;
  return set;
}

// an episode's folder appears only when it is complete
bool is_done(const EpisodeSet& set, std::uint64_t episode) {
  return fs::exists(episode_folder(set.folder, episode) / "summary.json");
}

std::optional<std::string> failure_of(const fs::path& folder, std::uint64_t episode) {
  const std::optional<Json> summary = read_json_file(failed_folder(folder, episode) / "summary.json");
  if (!summary) return std::nullopt;
  return text_in(*summary, "reason", failed_folder(folder, episode) / "summary.json");
}

SetStatus read_status(const fs::path& folder) {
  SetStatus status;
  for (const std::uint64_t episode : episodes_in(folder))
    if (fs::exists(episode_folder(folder, episode) / "summary.json")) status.done.push_back(episode);
  for (const std::uint64_t episode : episodes_in(folder / "failed")) {
    if (std::binary_search(status.done.begin(), status.done.end(), episode)) continue;
    if (const auto reason = failure_of(folder, episode)) status.failed.push_back({episode, *reason});
  }
  return status;
}

namespace {
Json to_json(const std::vector<FailedEpisode>& episodes) {
  Json list = Json::array();
  for (const FailedEpisode& episode : episodes)
    list.push_back({{"episode", episode.episode}, {"reason", episode.reason}});
  return list;
}
}  // namespace

std::vector<std::uint64_t> missing(const EpisodeSet& set, const SetStatus& status) {
  std::vector<bool> is_there(set.n_asked, false);
  for (const std::uint64_t episode : status.done)
    if (episode < set.n_asked) is_there[episode] = true;
  for (const FailedEpisode& failed : status.failed)
    if (failed.episode < set.n_asked) is_there[failed.episode] = true;
  std::vector<std::uint64_t> episodes;
  for (std::uint64_t episode = 0; episode < set.n_asked; ++episode)
    if (!is_there[episode]) episodes.push_back(episode);
  return episodes;
}

double success_rate(const SetStatus& status) {
  const std::size_t n = status.done.size() + status.failed.size();
  return n ? double(status.done.size()) / double(n) : 0;
}

RateInterval success_interval(const SetStatus& status) {
  return wilson_interval(status.done.size(), status.done.size() + status.failed.size());
}

std::string status_json(const EpisodeSet& set) {
  const SetStatus status = read_status(set.folder);
  const RateInterval interval = success_interval(status);
  const Json json = {{"schema", 1},
                     {"folder", set.folder.string()},
                     {"task", set.task},
                     {"seed", set.seed},
                     {"episodes", set.n_asked},
                     {"done", status.done},
                     {"failed", to_json(status.failed)},
                     {"missing", missing(set, status)},
                     {"success_rate", success_rate(status)},
                     {"success_low", interval.low},
                     {"success_high", interval.high}};
  return json.dump(2) + "\n";
}

void write_set(const EpisodeSet& set) {
  const SetStatus status = read_status(set.folder);
  Json versions = Json::object();
  for (const auto& [name, version] : set.versions) versions[name] = version;
  const Json json = {{"schema", 1},
                     {"task", set.task},
                     {"seed", set.seed},
                     {"configuration", set.configuration},
                     {"episodes", set.n_asked},
                     {"done", status.done},
                     {"failed", to_json(status.failed)},
                     {"versions", versions},
                     {"updated", utc_now()}};
  write_text_atomically(set.folder / "set.json", json.dump(2) + "\n");
}

std::string fingerprint(const std::string& text) { return fmt::format("{:016x}", fnv1a(text)); }

}  // namespace pvg
