#include "host/dataset/lerobot_dataset.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "host/base/atomic_files.hpp"
#include "host/base/error.hpp"
#include "host/dataset/feature_stats.hpp"
#include "host/formats/video.hpp"
#include "host/formats/video_reader.hpp"

namespace pvg {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr std::size_t PER_CHUNK = 1000;  // files in a folder; readers sort file-<three digits> as text
// What is below this hardly moves, and dividing by less would make noise of a real joint loud.
constexpr double LEAST_STD = 1e-2, LEAST_STD_OF_WIDTH = 1e-3;  // [rad], [m]
// Of an object: what a hand tilts or shifts in passing, which no demonstration need have shown. With 0.001 a policy
// whose demonstrations never tilt a beaker answers 0.01 rad of tilt with 0.1 rad of its joints.
constexpr double LEAST_STD_OF_POSITION = 1e-2, LEAST_STD_OF_QUATERNION = 5e-2;  // [m], [-]
constexpr std::size_t MOST_SAMPLED = 100;  // pictures of an episode that its statistics look at

std::string in_words(std::string name) {
  std::replace(name.begin(), name.end(), '_', ' ');
  return name;
}

// A feature whose numbers stand in the tables.
struct Feature {
  std::string name, type;          // f32 as "float", or "int64"
  std::vector<std::string> names;  // of the numbers; empty: one number, or unnamed ones
  std::size_t width = 1;
  std::vector<double> least_std;
  Rows all;  // of all episodes so far  [n_frames][width]
};

// as the tables hold it
double written(const Feature& feature, double x) {
  return feature.type == "int64" ? double(std::llround(x)) : double(float(x));
}

Json list_of(const Feature& feature, const Rows& rows) {
  const auto value = [&](double x) -> Json {
    if (feature.type == "int64") return std::int64_t(std::llround(x));
    return written(feature, x);
  };
  Json list = Json::array();
  for (const std::vector<double>& row : rows) {
    if (feature.width == 1) {
      list.push_back(value(row[0]));
      continue;
    }
    Json inner = Json::array();
    for (const double x : row) inner.push_back(value(x));
    list.push_back(std::move(inner));
  }
  return list;
}

Json stats_json(const Feature& feature, const Rows& rows, std::span<const double> least_std) {
  std::vector<NumberStats> stats;
  for (std::size_t i = 0; i < feature.width; ++i) {
    std::vector<double> values;
    for (const std::vector<double>& row : rows) values.push_back(written(feature, row[i]));
    stats.push_back(stats_of(std::move(values)));
  }
  return to_json(stats, rows.size(), false, least_std);
}

class LeRobotWriter : public DataSetWriter {
 public:
  LeRobotWriter(fs::path folder, LeRobotSettings settings, std::function<void(const ParquetTable&)> write)
      : folder_(std::move(folder)), settings_(std::move(settings)), write_(std::move(write)) {
    fs::create_directories(folder_ / "meta");
  }

  void add(const PackedEpisode& episode) override {
    if (n_episodes_ == 0) begin(episode);
    const std::vector<Rows> rows = rows_of(episode);
    ParquetTable data{made(data_path(n_episodes_)), {}, {}};
    Json stats = Json::object();
    for (std::size_t i = 0; i < features_.size(); ++i) {
      Feature& feature = features_[i];
      const std::string type = feature.width == 1 ? feature.type : "list<" + feature.type + ">";
      data.columns.push_back({feature.name, type, list_of(feature, rows[i])});
      stats[feature.name] = stats_json(feature, rows[i], least_std_of_episode(feature));
      feature.all.insert(feature.all.end(), rows[i].begin(), rows[i].end());
    }
    write_(data);
    for (const PackedCamera& camera : episode.cameras) stats[video_key(camera)] = add_video(camera, episode.n_frames());
    add_to_list(episode, stats);
    n_frames_ += episode.n_frames();
    ++n_episodes_;
  }

  void finish() override {
    Json stats = Json::object();
    for (const Feature& feature : features_) stats[feature.name] = stats_json(feature, feature.all, feature.least_std);
    for (const auto& [key, counts] : pixels_) stats[key] = to_json(counts.stats(), n_sampled_.at(key), true, {});
    if (is_v3()) {
      write_(episodes_table());
      write_(tasks_table());
      put("stats.json", stats.dump(2) + "\n");
    } else {
      put("tasks.jsonl", Json({{"task_index", 0}, {"task", instruction_}}).dump() + "\n");
      put("episodes.jsonl", lines(episodes_));
      put("episodes_stats.jsonl", lines(episode_stats_));
    }
    put("phyvisgen.json", settings_.origin.dump(2) + "\n");
    // last: a folder with it is complete
    put("info.json", info().dump(2) + "\n");
  }

 private:
  // 2.1 has no statistics of the set: readers make them of those of the episodes
  std::span<const double> least_std_of_episode(const Feature& feature) const {
    return is_v3() ? std::span<const double>() : feature.least_std;
  }
  bool is_v3() const { return settings_.version == LeRobotVersion::v3_0; }
  static std::string video_key(const PackedCamera& camera) { return "observation.images." + camera.name; }
  std::string data_path(std::size_t episode) const {
    const std::size_t chunk = episode / PER_CHUNK;
    return is_v3() ? fmt::format("data/chunk-{:03}/file-{:03}.parquet", chunk, episode % PER_CHUNK)
                   : fmt::format("data/chunk-{:03}/episode_{:06}.parquet", chunk, episode);
  }
  std::string video_path(std::size_t episode, const std::string& key) const {
    const std::size_t chunk = episode / PER_CHUNK;
    return is_v3() ? fmt::format("videos/{}/chunk-{:03}/file-{:03}.mp4", key, chunk, episode % PER_CHUNK)
                   : fmt::format("videos/chunk-{:03}/{}/episode_{:06}.mp4", chunk, key, episode);
  }
  fs::path made(const std::string& path) const {
    fs::create_directories((folder_ / path).parent_path());
    return folder_ / path;
  }
  void put(const std::string& name, const std::string& text) const {
    write_text_atomically(folder_ / "meta" / name, text);
  }
  static std::string lines(const Json& list) {
    std::string text;
    for (const Json& json : list) text += json.dump() + "\n";
    return text;
  }

  void begin(const PackedEpisode& first) {
    rate_ = first.frames_per_second;
    robot_ = first.robot;
    instruction_ = settings_.instruction.empty() ? in_words(first.task) : settings_.instruction;
    std::vector<double> least;
    for (const bool is_width : first.is_width) least.push_back(is_width ? LEAST_STD_OF_WIDTH : LEAST_STD);
    const std::size_t n = first.columns.size();
    features_ = {{"observation.state", "float", first.columns, n, least, {}},
                 {"action", "float", first.columns, n, least, {}}};
    if (settings_.has_environment) {
      std::vector<std::string> names;
      std::vector<double> least_of_environment;
      for (const EnvironmentColumn& column : first.environment_columns) {
        names.push_back(column.name);
        least_of_environment.push_back(column.is_length ? LEAST_STD_OF_POSITION : LEAST_STD_OF_QUATERNION);
      }
      features_.push_back({"observation.environment_state", "float", names, names.size(), least_of_environment, {}});
    }
    for (const PackedCamera& camera : first.cameras) {
      cameras_.push_back(camera);
      features_.push_back({"camera." + camera.name + ".K", "float", {}, 9, {}, {}});
      features_.push_back({"camera." + camera.name + ".T_world_camera", "float", {}, 16, {}, {}});
    }
    features_.push_back({"timestamp", "float", {}, 1, {}, {}});
    for (const char* name : {"frame_index", "episode_index", "index", "task_index"})
      features_.push_back({name, "int64", {}, 1, {}, {}});
  }

  // in the order of features_
  std::vector<Rows> rows_of(const PackedEpisode& episode) const {
    std::vector<Rows> rows = {episode.state, episode.action};
    if (settings_.has_environment) rows.push_back(episode.environment);
    for (const PackedCamera& camera : episode.cameras) {
      rows.push_back(camera.K);
      rows.push_back(camera.T_world_camera);
    }
    Rows timestamp, frame_index, episode_index, index, task_index;
    for (std::size_t f = 0; f < episode.n_frames(); ++f) {
      timestamp.push_back({double(f) / rate_});
      frame_index.push_back({double(f)});
      episode_index.push_back({double(n_episodes_)});
      index.push_back({double(n_frames_ + f)});
      task_index.push_back({0});
    }
    rows.insert(rows.end(), {timestamp, frame_index, episode_index, index, task_index});
    return rows;
  }

  Json add_video(const PackedCamera& camera, std::size_t n_frames) {
    const std::string key = video_key(camera);
    const fs::path to = made(video_path(n_episodes_, key));
    if (camera.start.empty()) {
      std::error_code error;
      fs::create_hard_link(camera.video, to, error);  // the same file by another name where the disk is the same
      if (error) fs::copy_file(camera.video, to);
    } else {
      join_videos(std::array{camera.start, camera.video}, to);
    }
    const std::size_t every = std::max<std::size_t>(1, n_frames / MOST_SAMPLED);
    PixelCounts counts;
    std::size_t n = 0, sampled = 0;
    // of the packed file, which is what readers will find
    demand_frames(camera, n_frames, read_video(to, camera.width, camera.height, 0, [&](auto rgb) {
                    if (n++ % every) return;
                    counts.add(rgb);
                    ++sampled;
                  }));
    pixels_[key].add(counts);
    n_sampled_[key] += sampled;
    return to_json(counts.stats(), sampled, true, {});
  }

  void add_to_list(const PackedEpisode& episode, const Json& stats) {
    const std::size_t i = n_episodes_, n = episode.n_frames();
    Json row = {{"episode_index", i}, {"tasks", Json::array({instruction_})}, {"length", n}};
    if (is_v3()) {
      row["data/chunk_index"] = i / PER_CHUNK;
      row["data/file_index"] = i % PER_CHUNK;
      row["dataset_from_index"] = n_frames_;
      row["dataset_to_index"] = n_frames_ + n;
      for (const PackedCamera& camera : episode.cameras) {
        const std::string key = "videos/" + video_key(camera);
        row[key + "/chunk_index"] = i / PER_CHUNK;
        row[key + "/file_index"] = i % PER_CHUNK;
        row[key + "/from_timestamp"] = 0.0;
        row[key + "/to_timestamp"] = double(n) / rate_;
      }
      for (const auto& [feature, of_feature] : stats.items())
        for (const auto& [name, value] : of_feature.items()) row["stats/" + feature + "/" + name] = value;
      row["meta/episodes/chunk_index"] = 0;
      row["meta/episodes/file_index"] = 0;
    } else {
      episode_stats_.push_back({{"episode_index", i}, {"stats", stats}});
    }
    episodes_.push_back(row);
  }

  static std::string type_of(const std::string& name, const Json& value) {
    if (value.is_array()) return "list<" + (name.ends_with("/count") ? "int64" : type_of(name, value.at(0))) + ">";
    if (value.is_string()) return "string";
    return value.is_number_float() ? "double" : "int64";
  }

  ParquetTable episodes_table() const {
    ParquetTable table{made("meta/episodes/chunk-000/file-000.parquet"), {}, {}};
    for (const auto& [name, first] : episodes_.at(0).items()) {
      ParquetColumn column{name, type_of(name, first), Json::array()};
      for (const Json& row : episodes_) column.values.push_back(row.at(name));
      table.columns.push_back(std::move(column));
    }
    return table;
  }

  // the task is what pandas calls the index of the table
  ParquetTable tasks_table() const {
    const auto column = [](const char* name, const char* type, const char* stored) -> Json {
      return {
          {"name", name}, {"field_name", name}, {"pandas_type", type}, {"numpy_type", stored}, {"metadata", nullptr}};
    };
    const Json pandas = {
        {"index_columns", Json::array({"task"})},
        {"column_indexes", Json::array()},
        {"columns", Json::array({column("task_index", "int64", "int64"), column("task", "unicode", "object")})},
        {"pandas_version", "1.5.0"}};
    return {made("meta/tasks.parquet"),
            {{"task_index", "int64", Json::array({0})}, {"task", "string", Json::array({instruction_})}},
            {{"pandas", pandas.dump()}}};
  }

  Json features_json() const {
    Json json = Json::object();
    for (const Feature& feature : features_)
      json[feature.name] = {{"dtype", feature.type == "float" ? "float32" : "int64"},
                            {"shape", Json::array({feature.width})},
                            {"names", feature.names.empty() ? Json(nullptr) : Json(feature.names)}};
    for (const PackedCamera& camera : cameras_)
      json[video_key(camera)] = {{"dtype", "video"},
                                 {"shape", {camera.height, camera.width, 3}},
                                 {"names", {"height", "width", "channels"}},
                                 {"info",
                                  {{"video.height", camera.height},
                                   {"video.width", camera.width},
                                   {"video.codec", "h264"},
                                   {"video.pix_fmt", "yuv420p"},
                                   {"video.is_depth_map", false},
                                   {"is_depth_map", false},
                                   {"video.fps", std::llround(rate_)},
                                   {"video.channels", 3},
                                   {"has_audio", false}}}};
    return json;
  }

  Json info() const {
    Json info = {{"codebase_version", is_v3() ? "v3.0" : "v2.1"},
                 {"robot_type", robot_},
                 {"total_episodes", n_episodes_},
                 {"total_frames", n_frames_},
                 {"total_tasks", 1}};
    if (is_v3()) {
      info["chunks_size"] = PER_CHUNK;
      info["data_files_size_in_mb"] = 100;
      info["video_files_size_in_mb"] = 200;
    } else {
      info["total_videos"] = n_episodes_ * cameras_.size();
      info["total_chunks"] = (n_episodes_ + PER_CHUNK - 1) / PER_CHUNK;
      info["chunks_size"] = PER_CHUNK;
    }
    info["fps"] = std::llround(rate_);
    info["splits"] = {{"train", "0:" + std::to_string(n_episodes_)}};
    info["data_path"] = is_v3() ? "data/chunk-{chunk_index:03d}/file-{file_index:03d}.parquet"
                                : "data/chunk-{episode_chunk:03d}/episode_{episode_index:06d}.parquet";
    info["video_path"] = is_v3() ? "videos/{video_key}/chunk-{chunk_index:03d}/file-{file_index:03d}.mp4"
                                 : "videos/chunk-{episode_chunk:03d}/{video_key}/episode_{episode_index:06d}.mp4";
    info["features"] = features_json();
    return info;
  }

  fs::path folder_;
  LeRobotSettings settings_;
  std::function<void(const ParquetTable&)> write_;
  double rate_ = 0;
  std::string robot_, instruction_;
  std::vector<Feature> features_;
  std::vector<PackedCamera> cameras_;
  std::size_t n_episodes_ = 0, n_frames_ = 0;
  Json episodes_ = Json::array(), episode_stats_ = Json::array();
  std::map<std::string, PixelCounts> pixels_;
  std::map<std::string, std::size_t> n_sampled_;
};

}  // namespace

std::unique_ptr<DataSetWriter> make_lerobot_writer(const fs::path& folder, const LeRobotSettings& settings,
                                                   const std::function<void(const ParquetTable&)>& write) {
  return std::make_unique<LeRobotWriter>(folder, settings, write);
}

}  // namespace pvg
