#include "pipeline/episode/episode_set.hpp"

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <ctime>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>

#include "host/base/atomic_files.hpp"
#include "host/base/error.hpp"

namespace pvg {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr std::string_view PREFIX = "episode_";

std::string episode_name(std::uint64_t episode) {
  char name[40];
  std::snprintf(name, sizeof name, "episode_%06llu", static_cast<unsigned long long>(episode));
  return name;
}

std::optional<std::uint64_t> episode_of(const std::string& name) {
  std::uint64_t number = 0;
  if (!name.starts_with(PREFIX)) return std::nullopt;
  const auto parsed = std::from_chars(name.data() + PREFIX.size(), name.data() + name.size(), number);
  if (parsed.ec != std::errc() || parsed.ptr != name.data() + name.size() || name != episode_name(number))
    return std::nullopt;
  return number;
}

std::optional<Json> read_json(const fs::path& path) {
  std::ifstream in(path);
  if (!in) return std::nullopt;
  Json json = Json::parse(in, nullptr, false);
  if (json.is_discarded()) throw UsageError(path.string() + " is no JSON file; remove it to begin anew");
  return json;
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

}  // namespace

fs::path episode_folder(const fs::path& set, std::uint64_t episode) { return set / episode_name(episode); }
fs::path failed_folder(const fs::path& set, std::uint64_t episode) { return set / "failed" / episode_name(episode); }

void join_set(EpisodeSet& set) {
  const fs::path path = set.folder / "set.json";
  const std::optional<Json> old = read_json(path);
  if (!old) return;
  const auto demand = [&](bool is_same, const char* what) {
    if (!is_same)
      throw UsageError(path.string() + ": this folder holds episodes of another " + what +
                       "; choose another folder with -o");
  };
  demand(old->value("task", "") == set.task, "task");
  demand(old->value("seed", std::uint64_t(0)) == set.seed, "seed");
  demand(old->value("configuration", "") == set.configuration, "configuration (the task file or an option differs)");
  set.n_asked = std::max(set.n_asked, old->value("episodes", std::uint64_t(0)));
}

EpisodeSet read_set(const fs::path& folder) {
  const fs::path path = folder / "set.json";
  const std::optional<Json> json = read_json(path);
  if (!json) throw UsageError(path.string() + " does not exist; name a folder that generate has filled");
  EpisodeSet set;
  set.folder = folder;
  try {
    set.task = json->at("task");
    set.seed = json->at("seed");
    set.n_asked = json->at("episodes");
    set.configuration = json->at("configuration");
    for (const auto& [name, version] : json->at("versions").items()) set.versions.emplace_back(name, version);
  } catch (const Json::exception&) {
    throw UsageError(path.string() + " is no set.json of generate: a key is missing or has the wrong type");
  }
  return set;
}

// an episode's folder appears only when it is complete
bool is_done(const EpisodeSet& set, std::uint64_t episode) {
  return fs::exists(episode_folder(set.folder, episode) / "summary.json");
}

std::optional<std::string> failure_of(const fs::path& folder, std::uint64_t episode) {
  const std::optional<Json> summary = read_json(failed_folder(folder, episode) / "summary.json");
  if (!summary) return std::nullopt;
  return summary->value("reason", "unknown");
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

std::string status_json(const EpisodeSet& set) {
  const SetStatus status = read_status(set.folder);
  const Json json = {{"schema", 1},
                     {"folder", set.folder.string()},
                     {"task", set.task},
                     {"seed", set.seed},
                     {"episodes", set.n_asked},
                     {"done", status.done},
                     {"failed", to_json(status.failed)},
                     {"missing", missing(set, status)},
                     {"success_rate", success_rate(status)}};
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

std::string fingerprint(const std::string& text) {
  std::uint64_t hash = 0xcbf29ce484222325u;
  for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3u;
  char hex[24];
  std::snprintf(hex, sizeof hex, "%016llx", static_cast<unsigned long long>(hash));
  return hex;
}

}  // namespace pvg
