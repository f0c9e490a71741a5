// LeRobot data sets, versions 3.0 and 2.1: meta/info.json and Parquet files below data/. Columns of both are
// observation.state, action, episode_index, frame_index; videos are not looked at.
#include <algorithm>
#include <fstream>
#include <map>

#include "host/base/counted.hpp"
#include "host/base/error.hpp"
#include "host/load/recording/robot_set.hpp"

namespace pvg {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

json read_info(const fs::path& file) {
  std::ifstream in(file);
  const json info = json::parse(in, nullptr, false);
  if (!info.is_object()) throw UsageError(file.string() + " is no JSON object; is this a LeRobot data set?");
  const json said = info.value("codebase_version", json(""));
  const std::string version = said.is_string() ? said.get<std::string>() : said.dump();
  if (!version.starts_with("v3.") && !version.starts_with("v2."))
    throw UsageError(file.string() + ": the version `" + version + "` is not known; v3.0 and v2.1 are");
  if (!info.contains("fps") || !info["fps"].is_number() || !(info["fps"].get<double>() > 0))
    throw UsageError(file.string() +
                     " does not say how many frames per second there are; `fps` must be a number above 0");
  return info;
}

// A list, or a mapping of one list as {"motors": [..]}; empty: the set names none.
std::vector<std::string> names_of(const json& info, const std::string& feature, const fs::path& file) {
  if (!info.contains("features") || !info["features"].contains(feature))
    throw UsageError(file.string() + " has no feature `" + feature + "`, which a diagnosis reads");
  const json& found = info["features"][feature];
  json names = found.contains("names") ? found["names"] : json();
  if (names.is_object() && names.size() == 1) names = names.begin().value();
  std::vector<std::string> all;
  if (names.is_array())
    for (const json& name : names)
      if (name.is_string()) all.push_back(name.get<std::string>());
  if (all.empty() || all.size() != names.size())
    throw UsageError(file.string() + ": the feature `" + feature +
                     "` has no `names`, so nobody knows which joints these numbers are of; add them there");
  return all;
}

std::vector<fs::path> tables_below(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code ignored;
  for (const auto& entry : fs::recursive_directory_iterator(folder, ignored))
    if (entry.path().extension() == ".parquet") files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  if (files.empty()) throw UsageError(folder.string() + " holds no Parquet file");
  return files;
}

double number_in(const json& value, const std::string& column) {
  if (!value.is_number()) throw UsageError("the column " + column + " holds something else than a number");
  return value.get<double>();
}

// a row of one number may be written as that number
std::vector<double> row_of(const json& value, const std::string& column, std::size_t width) {
  std::vector<double> row;
  if (value.is_array())
    for (const json& number : value) row.push_back(number_in(number, column));
  else
    row.push_back(number_in(value, column));
  if (row.size() != width)
    throw UsageError("the column " + column + " holds rows of " + counted(row.size(), "number") + ", its names are " +
                     std::to_string(width));
  return row;
}

// Rows of an episode in the order of their frames.
struct Rows {
  std::map<long, std::vector<double>> state, action;  // by frame_index
};

RobotEpisode episode_of(const std::string& name, const Rows& rows, const std::vector<std::string>& names, double fps) {
  RobotEpisode episode{name, {}, names, {}, {}};
  episode.state.resize(names.size());
  episode.target.resize(names.size());
  const std::vector<double>* told = &rows.state.begin()->second;  // it stands where it was told to be
  for (const auto& [frame, state] : rows.state) {
    episode.time.push_back(double(frame) / fps);
    for (std::size_t k = 0; k < names.size(); ++k) {
      episode.state[k].push_back(state[k]);
      episode.target[k].push_back((*told)[k]);
    }
    told = &rows.action.at(frame);
  }
  return episode;
}

}  // namespace

std::vector<RobotEpisode> read_lerobot_set(const fs::path& set, const ParquetReader& read_parquet) {
  const fs::path file = set / "meta/info.json";
  const json info = read_info(file);
  const std::vector<std::string> names = names_of(info, "observation.state", file);
  if (names_of(info, "action", file) != names)
    throw UsageError(file.string() +
                     ": `action` and `observation.state` have other names; a diagnosis needs the joint that each "
                     "command is for");
  const json table =
      read_parquet(tables_below(set / "data"), {"observation.state", "action", "episode_index", "frame_index"});
  std::map<long, Rows> episodes;
  for (std::size_t i = 0; i < table["frame_index"].size(); ++i) {
    Rows& rows = episodes[long(number_in(table["episode_index"][i], "episode_index"))];
    const long frame = long(number_in(table["frame_index"][i], "frame_index"));
    rows.state[frame] = row_of(table["observation.state"][i], "observation.state", names.size());
    rows.action[frame] = row_of(table["action"][i], "action", names.size());
  }
  std::vector<RobotEpisode> all;
  for (const auto& [number, rows] : episodes)
    all.push_back(episode_of("episode " + std::to_string(number), rows, names, info["fps"].get<double>()));
  return all;
}

}  // namespace pvg
