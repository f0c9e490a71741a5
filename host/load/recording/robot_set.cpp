#include "host/load/recording/robot_set.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "host/base/counted.hpp"
#include "host/base/error.hpp"
#include "host/hdf5/file.hpp"
#include "host/load/task_file.hpp"

namespace pvg {
namespace {

namespace fs = std::filesystem;
constexpr std::size_t LEAST_ROWS = 8;  // of a run

// ---- our own records: /time [T], /q [T, J] and the targets /a [T, J] of the driven joints, with /disturbance [T, J]
// what pushed them away, which the drives followed

RobotEpisode read_states(const fs::path& file, const std::string& name) {
  const hdf5::File in = hdf5::File::open(file);
  for (const char* object : {"/time", "/q", "/a"})
    if (!in.has(object))
      throw UsageError(file.string() + " is no states file of simulate or generate: it lacks " + object);
  RobotEpisode episode{name, in.read<double>("/time").values, in.texts_attribute("/q", "names"), {}, {}};
  const std::size_t n = episode.time.size(), width = episode.names.size();
  const auto columns = [&](const char* object) {
    const std::vector<double> values = in.read<double>(object).values;
    if (values.size() != n * width)
      throw UsageError(file.string() + " is damaged: " + object +
                       " has another number of values than /time and its names");
    std::vector<std::vector<double>> all(width, std::vector<double>(n));
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (!std::isfinite(values[i]))
        throw UsageError(file.string() + " is damaged: " + object + " holds what is no finite number");
      all[i % width][i / width] = values[i];
    }
    return all;
  };
  episode.state = columns("/q");
  episode.target = columns("/a");
  if (in.has("/disturbance")) {
    const std::vector<std::vector<double>> pushed = columns("/disturbance");
    for (std::size_t j = 0; j < width; ++j)
      for (std::size_t i = 0; i < n; ++i) episode.target[j][i] += pushed[j][i];
  }
  return episode;
}

std::vector<RobotEpisode> read_episodes(const fs::path& set, const ParquetReader& read_parquet) {
  if (fs::exists(set / "meta/info.json")) return read_lerobot_set(set, read_parquet);
  if (fs::is_regular_file(set)) return {read_states(set, set.filename().string())};
  if (fs::exists(set / "states.h5")) return {read_states(set / "states.h5", set.filename().string())};
  std::vector<fs::path> folders;
  for (const auto& entry : fs::directory_iterator(set))
    if (fs::exists(entry.path() / "states.h5")) folders.push_back(entry.path());
  std::sort(folders.begin(), folders.end());
  std::vector<RobotEpisode> episodes;
  for (const fs::path& folder : folders)
    episodes.push_back(read_states(folder / "states.h5", folder.filename().string()));
  return episodes;
}

// ---- names

std::string without_slashes(std::string name) {
  std::replace(name.begin(), name.end(), '/', '_');
  return name;
}

// joint1.pos and joint1_pos are joint1
std::string without_ending(const std::string& name) {
  for (const char* ending : {".pos", "_pos", ".position", "_position"})
    if (name.ends_with(ending)) return name.substr(0, name.size() - std::string(ending).size());
  return name;
}

// What a column is of: one joint, or the joints of a gripper, whose width is their sum.
std::vector<std::string> joints_of(const std::string& column, const PhysicalScene& scene,
                                   const std::vector<RobotCell>& robots) {
  for (const Joint& joint : scene.joints)
    if (is_driven(joint) && (column == joint.name || without_ending(column) == without_slashes(joint.name)))
      return {joint.name};
  for (const RobotCell& robot : robots) {
    const std::string prefix = robot.name.empty() ? "" : robot.name + "/";
    if (!robot.gripper || column != without_slashes(prefix + "gripper_width")) continue;
    std::vector<std::string> joints;
    for (const std::string& joint : robot.gripper->joints) joints.push_back(prefix + joint);
    return joints;
  }
  return {};
}

std::string listed(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

std::vector<std::string> driven_joints(const PhysicalScene& scene) {
  std::vector<std::string> names;
  for (const Joint& joint : scene.joints)
    if (is_driven(joint)) names.push_back(joint.name);
  return names;
}

// Column k of an episode in which a joint is, and its share of it; k < 0: none.
struct Place {
  int column = -1;
  double share = 1;
};

Place place_of(const std::string& joint, const std::vector<std::vector<std::string>>& joints_of_columns) {
  for (std::size_t k = 0; k < joints_of_columns.size(); ++k) {
    const std::vector<std::string>& joints = joints_of_columns[k];
    if (std::find(joints.begin(), joints.end(), joint) != joints.end()) return {int(k), 1 / double(joints.size())};
  }
  return {};
}

std::vector<double> scaled(std::vector<double> values, double by) {
  for (double& value : values) value *= by;
  return values;
}

std::string exactly(double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%.17g", value);
  return text;
}

// ---- the recording

// It starts at rest where it is seen first.
RecordedRun run_of(const RobotEpisode& episode, const std::vector<std::string>& joints,
                   const std::vector<Place>& places, const fs::path& set) {
  if (episode.time.size() < LEAST_ROWS)
    throw UsageError(set.string() + ": the " + episode.name + " holds " + counted(episode.time.size(), "row") +
                     "; a run needs at least " + std::to_string(LEAST_ROWS));
  for (std::size_t i = 1; i < episode.time.size(); ++i)
    if (!(episode.time[i] > episode.time[i - 1]))
      throw UsageError(set.string() + ": the times of the " + episode.name + " do not ascend at row " +
                       std::to_string(i));
  RecordedRun run;
  run.name = episode.name;
  run.table.file = set;
  run.table.n_rows = episode.time.size();
  run.table.columns["t"] = episode.time;
  for (std::size_t j = 0; j < joints.size(); ++j) {
    const std::size_t column = std::size_t(places[j].column);
    run.table.columns["state " + joints[j]] = scaled(episode.state[column], places[j].share);
    run.table.columns["target " + joints[j]] = scaled(episode.target[column], places[j].share);
    run.initial["joint/" + joints[j] + "/position"] = {{exactly(run.table["state " + joints[j]][0])}, ""};
  }
  return run;
}

void hold_out(std::vector<RecordedRun>& runs) {
  const std::size_t n = runs.size() < 2 ? 0 : std::max<std::size_t>(1, runs.size() / 4);
  for (std::size_t i = runs.size() - n; i < runs.size(); ++i) runs[i].is_held_out = true;
}

}  // namespace

bool is_robot_set(const fs::path& path) {
  std::error_code ignored;
  if (fs::is_regular_file(path, ignored)) return path.extension() == ".h5" || path.extension() == ".hdf5";
  if (!fs::is_directory(path, ignored) || fs::exists(path / "recording.yaml")) return false;
  return fs::exists(path / "meta/info.json") || fs::exists(path / "set.json") || fs::exists(path / "states.h5");
}

Recording load_robot_set(const fs::path& set, const fs::path& task, const ParquetReader& read_parquet) {
  if (!is_task_file(task))
    throw UsageError(task.string() + " is no task: it has no `motion`; name the task whose robots made the set");
  if (!fs::exists(set)) throw UsageError(set.string() + " is not there; name a set of episodes, or a states.h5");
  const std::vector<RobotEpisode> episodes = read_episodes(set, read_parquet);
  if (episodes.empty())
    throw UsageError(set.string() + " holds neither recording.yaml nor episodes nor meta/info.json of a LeRobot set");
  const SceneRun alone = load_robots_alone(task);
  const std::vector<RobotCell> robots = robots_of(load_task(task));
  std::vector<std::vector<std::string>> joints_of_columns;
  for (const std::string& column : episodes[0].names)
    joints_of_columns.push_back(joints_of(column, alone.scene, robots));
  Recording recording;
  recording.file = set;
  recording.scene = fs::absolute(task);
  recording.initial = Recording::Initial::given;
  recording.has_robots_alone = true;
  const std::vector<std::string> joints = driven_joints(alone.scene);
  std::vector<Place> places;
  for (const std::string& joint : joints) {
    places.push_back(place_of(joint, joints_of_columns));
    if (places.back().column < 0)
      throw UsageError(set.string() + " has no column of the joint `" + joint + "` of " + task.string() +
                       "; it has: " + listed(episodes[0].names) + "; rename its columns or the task's joints");
    recording.inputs.push_back({{"target " + joint}, "joint/" + joint + "/position", ""});
    if (places.back().share != 1) continue;  // a width says nothing of a single finger
    RecordedChannel channel;
    channel.kind = ChannelKind::position;
    channel.columns = {"state " + joint};
    channel.joint = joint;
    recording.channels.push_back(channel);
  }
  for (const RobotEpisode& episode : episodes) {
    if (episode.names != episodes[0].names)
      throw UsageError(set.string() + ": the " + episode.name + " has other columns than the first");
    recording.runs.push_back(run_of(episode, joints, places, set));
  }
  hold_out(recording.runs);
  return recording;
}

}  // namespace pvg
