#include "host/dataset/packed_episode.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "host/base/counted.hpp"
#include "host/base/error.hpp"
#include "host/dataset/json_file.hpp"
#include "host/dataset/packed_columns.hpp"
#include "host/dataset/states_record.hpp"
#include "host/formats/video_reader.hpp"
#include "host/load/task_file.hpp"

namespace pvg {
namespace {

namespace fs = std::filesystem;

// The robots of the recorded configuration.
std::vector<RobotCell> read_robots(const Task& task, const StatesRecord& record) {
  const std::vector<RobotCell> robots = robots_of(task);
  const auto is_whole = [](const RobotCell& robot) { return !robot.gripper || !robot.gripper->joints.empty(); };
  if (robots.empty() || !std::all_of(robots.begin(), robots.end(), is_whole))
    throw UsageError(record.path().string() +
                     " is damaged: its attribute `configuration` is not what generate writes; make the record again");
  return robots;
}

std::vector<double> sums(const StatesRecord::Series& series, std::size_t step,
                         const std::vector<PackedColumn>& columns) {
  std::vector<double> row;
  for (const PackedColumn& column : columns) {
    double sum = 0;
    for (const std::size_t j : column.joints) sum += series.at(step, j);
    row.push_back(sum);
  }
  return row;
}

// Of a cloth: its keypoints, and its points at every step.
struct RecordedCloth {
  ClothKeypoints keypoints;
  std::string data_set;
  std::size_t n_points = 0;
  std::vector<Vec3> points;  // [T x n_points]
  std::span<const Vec3> at(std::size_t step) const { return std::span(points).subspan(step * n_points, n_points); }
};

// values: [n x 3]
std::vector<Vec3> points_of(const std::vector<double>& values) {
  std::vector<Vec3> points;
  for (std::size_t i = 0; i + 2 < values.size(); i += 3) points.emplace_back(values[i], values[i + 1], values[i + 2]);
  return points;
}

// Those that the recorded configuration names. filmed: steps whose points are asked for.
std::vector<RecordedCloth> read_cloths(const Task& task, const StatesRecord& record,
                                       const std::vector<std::size_t>& filmed) {
  std::vector<RecordedCloth> cloths;
  if (task.cloths.empty()) return cloths;
  const std::vector<std::size_t> kept = record.kept_steps();
  for (const std::size_t step : filmed)
    if (!std::binary_search(kept.begin(), kept.end(), step))
      throw UsageError(record.path().string() + " keeps no nodes of step " + std::to_string(step) +
                       "; make the record again with `record: {states: float32}`");
  for (const StatesRecord::Body& body : record.bodies()) {
    const auto is_body = [&](const ClothSection& section) { return section.cloth.name == body.name; };
    if (std::none_of(task.cloths.begin(), task.cloths.end(), is_body)) continue;
    const std::vector<Vec3> rest = points_of(record.mesh(body).rest);
    if (rest.empty()) throw UsageError(record.path().string() + " is damaged: `" + body.name + "` has no points");
    cloths.push_back(
        {cloth_keypoints(body.name, rest), body.data_set, rest.size(), points_of(record.rows(body.data_set))});
  }
  return cloths;
}

// poses: [T, n, 3, 4]
Eigen::Matrix4d pose_at(const std::vector<double>& poses, std::size_t n, std::size_t step, std::size_t body) {
  Eigen::Matrix4d pose = Eigen::Matrix4d::Identity();
  pose.topRows<3>() = Eigen::Map<const Eigen::Matrix<double, 3, 4, Eigen::RowMajor>>(&poses[(step * n + body) * 12]);
  return pose;
}

Rows rows_of(const std::vector<double>& values, std::size_t n) {
  Rows rows;
  const std::size_t width = n ? values.size() / n : 0;
  for (std::size_t i = 0; i < n; ++i)
    rows.emplace_back(values.begin() + std::ptrdiff_t(i * width), values.begin() + std::ptrdiff_t((i + 1) * width));
  return rows;
}

std::vector<PackedCamera> read_cameras(const fs::path& folder, const StatesRecord& record, std::size_t n_frames,
                                       const SummaryPictures& pictures, const std::vector<std::string>& asked,
                                       bool has_start) {
  std::vector<PackedCamera> cameras;
  const auto is_asked = [&](const std::string& name) {
    return asked.empty() || std::find(asked.begin(), asked.end(), name) != asked.end();
  };
  for (const SummaryCamera& shown : pictures.cameras) {
    if (!is_asked(shown.name)) continue;
    PackedCamera& camera = cameras.emplace_back();
    camera.name = shown.name;
    camera.width = shown.width;
    camera.height = shown.height;
    camera.video = folder / (shown.name + ".mp4");
    const StatesRecord::CameraRows rows = record.camera(shown.name, n_frames);
    camera.K = rows_of(rows.K, n_frames);
    camera.T_world_camera = rows_of(rows.T_world_camera, n_frames);
    if (has_start) {
      camera.start = start_video(folder, shown.name);
      camera.K.insert(camera.K.begin(), camera.K.front());
      camera.T_world_camera.insert(camera.T_world_camera.begin(), record.start_camera(shown.name));
    }
    camera.moves = std::any_of(camera.T_world_camera.begin(), camera.T_world_camera.end(),
                               [&](const auto& pose) { return pose != camera.T_world_camera.front(); });
  }
  for (const std::string& name : asked)
    if (std::none_of(cameras.begin(), cameras.end(), [&](const PackedCamera& c) { return c.name == name; }))
      throw UsageError(folder.string() + " has no camera `" + name + "`");
  return cameras;
}

}  // namespace

namespace {

// The last step of each period of a picture.
std::vector<std::size_t> last_steps(std::size_t n_steps, double frames_per_second, double time_step) {
  const double length = std::max(1.0, std::round(1 / (frames_per_second * time_step)));
  std::vector<std::size_t> steps;
  if (length > double(n_steps)) return steps;
  const auto per_frame = std::size_t(length);
  for (std::size_t step = per_frame - 1; step < n_steps; step += per_frame) steps.push_back(step);
  return steps;
}

// Where everything is at one instant: row `at` of each of these, and the points of each cloth.
struct Instant {
  const StatesRecord::Series& q;
  const std::vector<double>&T_link, &T_rigid;
  std::size_t at;
  std::vector<std::span<const Vec3>> cloths;
};

// What rows are made of.
struct RecordedRows {
  StatesRecord::Series q, a;
  std::vector<std::string> links, objects;
  std::vector<RecordedCloth> cloths;
  std::vector<PackedToolJoints> tools;
  std::vector<PackedColumn> columns;
};

// robots: of the recorded configuration `task`; filmed: the step of each row after the start.
RecordedRows read_recorded(const StatesRecord& record, const Task& task, const std::vector<RobotCell>& robots,
                           const std::vector<std::size_t>& filmed) {
  RecordedRows rows{record.series("/q"),
                    record.series("/a"),
                    record.poses_names("/T_link"),
                    record.poses_names("/T_rigid"),
                    {},
                    {},
                    {}};
  if (rows.a.names != rows.q.names)
    throw UsageError(record.path().string() + " is damaged: /a and /q are of different joints");
  rows.cloths = read_cloths(task, record, filmed);
  rows.tools = find_tools(robots, rows.links, rows.q.names);
  rows.columns = find_columns(rows.q.names, rows.tools);
  return rows;
}

// An episode without rows: its names.
PackedEpisode named_episode(const StatesRecord& record, const RecordedRows& rows, const RobotCell& first_robot) {
  PackedEpisode episode;
  episode.number = record.whole("episode");
  episode.task = record.text("task");
  episode.robot = first_robot.robot.urdf.stem().string();
  for (const PackedColumn& column : rows.columns) {
    episode.columns.push_back(column.name);
    episode.is_width.push_back(column.is_width);
  }
  for (const std::string& name : rows.objects) episode.objects.push_back({without_slashes(name), {}});
  std::vector<ClothKeypoints> keypoints;
  for (const RecordedCloth& cloth : rows.cloths) keypoints.push_back(cloth.keypoints);
  episode.environment_columns = environment_columns(rows.objects, keypoints);
  for (const PackedToolJoints& tool : rows.tools) episode.tools.push_back({without_slashes(tool.base), {}, {}, {}});
  return episode;
}

// next: the step at whose end the following picture is taken
void add_row(PackedEpisode& episode, const RecordedRows& rows, const Instant& now, std::size_t next) {
  episode.state.push_back(sums(now.q, now.at, rows.columns));
  episode.action.push_back(sums(rows.a, next, rows.columns));
  for (std::size_t i = 0; i < rows.tools.size(); ++i) {
    const PackedToolJoints& tool = rows.tools[i];
    const std::vector<PackedColumn> width = {{"", tool.joints, true}};
    episode.tools[i].pose.push_back(pose_at(now.T_link, rows.links.size(), now.at, tool.link) * tool.tool_center);
    episode.tools[i].width.push_back(sums(now.q, now.at, width)[0]);
    episode.tools[i].width_action.push_back(sums(rows.a, next, width)[0]);
  }
  std::vector<double>& environment = episode.environment.emplace_back();
  for (std::size_t i = 0; i < episode.objects.size(); ++i) {
    episode.objects[i].pose.push_back(pose_at(now.T_rigid, rows.objects.size(), now.at, i));
    const auto numbers = pose_numbers(episode.objects[i].pose.back().topRows<3>());
    environment.insert(environment.end(), numbers.begin(), numbers.end());
  }
  for (std::size_t i = 0; i < rows.cloths.size(); ++i) {
    const auto numbers = keypoint_numbers(rows.cloths[i].keypoints, now.cloths[i]);
    environment.insert(environment.end(), numbers.begin(), numbers.end());
  }
}

// The row of the recorded start, before the first step.
void add_start(PackedEpisode& episode, const StatesRecord& record, const RecordedRows& rows, std::size_t next) {
  const StatesRecord::Series q{rows.q.names, record.start("/q")};
  const std::vector<double> T_link = record.start("/T_link"), T_rigid = record.start("/T_rigid");
  std::vector<std::vector<Vec3>> points;
  std::vector<std::span<const Vec3>> spans;
  for (const RecordedCloth& cloth : rows.cloths) points.push_back(points_of(record.start(cloth.data_set)));
  for (const std::vector<Vec3>& each : points) spans.emplace_back(each);
  add_row(episode, rows, {q, T_link, T_rigid, 0, spans}, next);
  episode.velocity.emplace_back(rows.columns.size(), 0);
}

// Everything but the cameras; filmed: the step of each row after the start.
PackedEpisode read_rows(const StatesRecord& record, const std::vector<std::size_t>& filmed, double frames_per_second,
                        bool has_start) {
  const Task task = read_resolved(record.text("configuration"), record.path());
  const std::vector<RobotCell> robots = read_robots(task, record);
  const RecordedRows rows = read_recorded(record, task, robots, filmed);
  PackedEpisode episode = named_episode(record, rows, robots.front());
  episode.frames_per_second = frames_per_second;

  const std::vector<double> T_link = record.poses("/T_link"), T_rigid = record.poses("/T_rigid");
  if (has_start && !filmed.empty()) add_start(episode, record, rows, filmed.front());
  const double h = record.positive("h");
  for (std::size_t f = 0; f < filmed.size(); ++f) {
    const std::size_t step = filmed[f];
    std::vector<std::span<const Vec3>> points;
    for (const RecordedCloth& cloth : rows.cloths) points.push_back(cloth.at(step));
    add_row(episode, rows, {rows.q, T_link, T_rigid, step, points}, f + 1 < filmed.size() ? filmed[f + 1] : step);
    // of the last step; the first one has none before it and starts from rest
    std::vector<double>& velocity = episode.velocity.emplace_back(rows.columns.size(), 0);
    if (step > 0) {
      const std::vector<double> before = sums(rows.q, step - 1, rows.columns);
      for (std::size_t i = 0; i < velocity.size(); ++i) velocity[i] = (episode.state.back()[i] - before[i]) / h;
    }
  }
  return episode;
}

}  // namespace

fs::path start_video(const fs::path& folder, const std::string& camera) { return folder / "start" / (camera + ".mp4"); }

bool has_packed_start_of_states(const fs::path& folder) { return StatesRecord(folder / "states.h5").has_start(); }

// What lacks pictures, or a camera that is asked for, lacks no start: reading it says what is missing.
bool has_packed_start(const fs::path& folder, const std::vector<std::string>& cameras) {
  const StatesRecord record(folder / "states.h5");
  if (!record.has_start() || record.filmed_steps().empty()) return record.has_start();
  const std::vector<SummaryCamera> there = read_summary_pictures(folder / "summary.json").cameras;
  return std::all_of(there.begin(), there.end(), [&](const SummaryCamera& camera) {
    const bool is_asked = cameras.empty() || std::find(cameras.begin(), cameras.end(), camera.name) != cameras.end();
    return !is_asked || fs::is_regular_file(start_video(folder, camera.name));
  });
}

PackedEpisode read_packed_episode(const fs::path& folder, const std::vector<std::string>& cameras, bool has_start) {
  const SummaryPictures pictures = read_summary_pictures(folder / "summary.json");
  const StatesRecord record(folder / "states.h5");
  const std::vector<std::size_t> filmed = record.filmed_steps();
  if (filmed.empty())
    throw UsageError(folder.string() +
                     " has no pictures: make it without --no-render, render it before packing, or "
                     "pack joints alone with --no-pictures");
  PackedEpisode episode = read_rows(record, filmed, pictures.frames_per_second, has_start);
  episode.cameras = read_cameras(folder, record, filmed.size(), pictures, cameras, has_start);
  return episode;
}

PackedEpisode read_packed_states(const fs::path& folder, bool has_start) {
  const double frames_per_second = read_summary_pictures(folder / "summary.json").frames_per_second;
  const StatesRecord record(folder / "states.h5");
  const std::vector<std::size_t> steps = last_steps(record.n_steps(), frames_per_second, record.positive("h"));
  if (steps.empty())
    throw UsageError(
        fmt::format("{} is shorter than one period of the {:g} pictures per second that its summary.json "
                    "says; make the episode again",
                    folder.string(), frames_per_second));
  return read_rows(record, steps, frames_per_second, has_start);
}

void read_pictures(const PackedCamera& camera, std::size_t n_frames, int side,
                   const std::function<void(std::span<const std::uint8_t> rgb)>& take) {
  std::size_t n_pictures = 0;
  for (const fs::path& video : {camera.start, camera.video})
    if (!video.empty()) n_pictures += read_video(video, camera.width, camera.height, side, take);
  demand_frames(camera, n_frames, n_pictures);
}

void demand_frames(const PackedCamera& camera, std::size_t n_frames, std::size_t n_pictures) {
  if (n_pictures != n_frames)
    throw Failure(camera.video.string() + " holds " + counted(n_pictures, "picture") + ", its episode " +
                  std::to_string(n_frames) + "; make the episode again");
}

void add(PackedSet& set, const PackedEpisode& first, const PackedEpisode& episode) {
  const auto same_camera = [](const PackedCamera& a, const PackedCamera& b) {
    return a.name == b.name && a.width == b.width && a.height == b.height;
  };
  if (episode.columns != first.columns || episode.frames_per_second != first.frames_per_second ||
      !std::equal(episode.cameras.begin(), episode.cameras.end(), first.cameras.begin(), first.cameras.end(),
                  same_camera))
    throw UsageError("episode " + std::to_string(episode.number) +
                     " has other joints, cameras or another rate than episode " + std::to_string(first.number) +
                     "; a data set holds episodes of one kind");
  ++set.n_episodes;
  set.n_frames += episode.n_frames();
  set.most_frames = std::max(set.most_frames, episode.n_frames());
  if (set.least_action.empty()) set.least_action = set.most_action = episode.action.front();
  for (const std::vector<double>& action : episode.action)
    for (std::size_t i = 0; i < action.size(); ++i) {
      set.least_action[i] = std::min(set.least_action[i], action[i]);
      set.most_action[i] = std::max(set.most_action[i], action[i]);
    }
}

}  // namespace pvg
