#include "host/dataset/packed_episode.hpp"

#include <yaml-cpp/yaml.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>

#include "host/base/error.hpp"
#include "host/formats/hdf5.hpp"

namespace pvg {
namespace {

namespace fs = std::filesystem;
using hdf5::Array;
using Json = nlohmann::ordered_json;

// What the resolved configuration says of a gripper.
struct GripperNames {
  std::string base_link;
  std::vector<std::string> joints;
  Eigen::Matrix4d tool_center = Eigen::Matrix4d::Identity();
};

void find_grippers(const YAML::Node& node, std::vector<GripperNames>& found) {
  const YAML::Node gripper = node["gripper"];
  if (!gripper || !gripper.IsMap()) return;
  GripperNames names;
  names.base_link = gripper["base_link"].as<std::string>();
  names.joints = gripper["joints"].as<std::vector<std::string>>();
  const auto p = gripper["tool_center"]["position"].as<std::vector<double>>();
  const auto q = gripper["tool_center"]["quaternion"].as<std::vector<double>>();  // x, y, z, w
  names.tool_center.topLeftCorner<3, 3>() = Eigen::Quaterniond(q.at(3), q.at(0), q.at(1), q.at(2)).toRotationMatrix();
  names.tool_center.topRightCorner<3, 1>() << p.at(0), p.at(1), p.at(2);
  found.push_back(names);
}

struct Configuration {
  std::string robot;
  std::vector<GripperNames> grippers;
};

Configuration read_configuration(const hdf5::File& file) {
  const YAML::Node root = YAML::Load(file.text_attribute("/", "configuration"));
  Configuration found;
  const auto take = [&](const YAML::Node& cell) {
    find_grippers(cell, found.grippers);
    const YAML::Node robot = cell["robot"];
    if (found.robot.empty() && robot && robot.IsMap() && robot["urdf"])
      found.robot = fs::path(robot["urdf"].as<std::string>()).stem().string();
  };
  take(root);
  for (const YAML::Node& cell : root["robots"]) take(cell);
  return found;
}

// "left/gripper_base" is the part gripper_base of the robot left
std::optional<std::string> robot_prefix(const std::string& name, const std::string& part) {
  if (name == part) return "";
  if (!name.ends_with("/" + part)) return std::nullopt;
  return name.substr(0, name.size() - part.size());
}

std::string without_slashes(std::string name) {
  std::replace(name.begin(), name.end(), '/', '_');
  return name;
}

// The base of a gripper as it stands in /T_link, and the columns of its joints in /q.
struct Tool {
  std::string prefix, base;
  std::size_t link = 0;
  std::vector<std::size_t> joints;
  Eigen::Matrix4d tool_center;
};

std::vector<Tool> find_tools(const std::vector<GripperNames>& grippers, const std::vector<std::string>& links,
                             const std::vector<std::string>& joints) {
  std::vector<Tool> tools;
  for (std::size_t link = 0; link < links.size(); ++link)
    for (const GripperNames& gripper : grippers) {
      const auto prefix = robot_prefix(links[link], gripper.base_link);
      if (!prefix) continue;
      Tool tool{*prefix, links[link], link, {}, gripper.tool_center};
      for (const std::string& name : gripper.joints) {
        const auto at = std::find(joints.begin(), joints.end(), *prefix + name);
        if (at != joints.end()) tool.joints.push_back(std::size_t(at - joints.begin()));
      }
      tools.push_back(tool);
      break;
    }
  return tools;
}

// Columns of the packed rows: a joint, or the joints of one gripper.
struct Column {
  std::string name;
  std::vector<std::size_t> joints;
  bool is_width = false;
};

std::vector<Column> find_columns(const std::vector<std::string>& joints, const std::vector<Tool>& tools) {
  std::vector<Column> columns;
  for (std::size_t j = 0; j < joints.size(); ++j) {
    const auto tool = std::find_if(tools.begin(), tools.end(), [&](const Tool& t) {
      return std::find(t.joints.begin(), t.joints.end(), j) != t.joints.end();
    });
    if (tool == tools.end())
      columns.push_back({without_slashes(joints[j]), {j}, false});
    else if (tool->joints.front() == j)
      columns.push_back({without_slashes(tool->prefix + "gripper_width"), tool->joints, true});
  }
  return columns;
}

std::vector<double> sums(const Array<double>& series, std::size_t step, const std::vector<Column>& columns) {
  std::vector<double> row;
  for (const Column& column : columns) {
    double sum = 0;
    for (const std::size_t j : column.joints) sum += series.values.at(step * series.shape.at(1) + j);
    row.push_back(sum);
  }
  return row;
}

Eigen::Matrix4d pose_at(const Array<double>& poses, std::size_t step, std::size_t body) {
  Eigen::Matrix4d pose = Eigen::Matrix4d::Identity();
  pose.topRows<3>() = Eigen::Map<const Eigen::Matrix<double, 3, 4, Eigen::RowMajor>>(
      &poses.values.at((step * poses.shape.at(1) + body) * 12));
  return pose;
}

Rows rows_of(const Array<double>& array) {
  Rows rows;
  const std::size_t width = array.values.size() / array.shape.at(0);
  for (std::size_t i = 0; i < array.shape[0]; ++i)
    rows.emplace_back(array.values.begin() + std::ptrdiff_t(i * width),
                      array.values.begin() + std::ptrdiff_t((i + 1) * width));
  return rows;
}

std::vector<PackedCamera> read_cameras(const fs::path& folder, const hdf5::File& file, const Json& summary,
                                       const std::vector<std::string>& asked) {
  std::vector<PackedCamera> cameras;
  const auto is_asked = [&](const std::string& name) {
    return asked.empty() || std::find(asked.begin(), asked.end(), name) != asked.end();
  };
  for (const auto& [name, size] : summary.at("cameras").items()) {
    if (!is_asked(name)) continue;
    PackedCamera& camera = cameras.emplace_back();
    camera.name = name;
    camera.width = size.at("width");
    camera.height = size.at("height");
    camera.video = folder / (name + ".mp4");
    camera.K = rows_of(file.read<double>("/camera/" + name + "/K"));
    camera.T_world_camera = rows_of(file.read<double>("/camera/" + name + "/T_world_camera"));
    camera.moves = std::any_of(camera.T_world_camera.begin(), camera.T_world_camera.end(),
                               [&](const auto& pose) { return pose != camera.T_world_camera.front(); });
  }
  for (const std::string& name : asked)
    if (std::none_of(cameras.begin(), cameras.end(), [&](const PackedCamera& c) { return c.name == name; }))
      throw UsageError(folder.string() + " has no camera `" + name + "`");
  return cameras;
}

Json read_summary(const fs::path& folder) {
  std::ifstream in(folder / "summary.json");
  const Json summary = Json::parse(in, nullptr, false);
  if (summary.is_discarded() || !summary.contains("cameras") || !summary.contains("frames_per_second"))
    throw UsageError((folder / "summary.json").string() + " is no summary of an episode; make the episode again");
  return summary;
}

}  // namespace

PackedEpisode read_packed_episode(const fs::path& folder, const std::vector<std::string>& cameras) {
  const Json summary = read_summary(folder);
  const hdf5::File file = hdf5::File::open(folder / "states.h5");
  const std::vector<std::int64_t> frame_step = file.read<std::int64_t>("/frame_step").values;
  if (frame_step.empty())
    throw UsageError(folder.string() + " has no pictures: make it without --no-render, or render it, before packing");
  const auto joints = file.texts_attribute("/q", "names"), links = file.texts_attribute("/T_link", "names");
  const Configuration configuration = read_configuration(file);
  const std::vector<Tool> tools = find_tools(configuration.grippers, links, joints);
  const std::vector<Column> columns = find_columns(joints, tools);

  PackedEpisode episode;
  episode.number = file.unsigned_attribute("/", "episode");
  episode.task = file.text_attribute("/", "task");
  episode.robot = configuration.robot;
  episode.frames_per_second = summary.at("frames_per_second");
  for (const Column& column : columns) {
    episode.columns.push_back(column.name);
    episode.is_width.push_back(column.is_width);
  }
  for (const std::string& name : file.texts_attribute("/T_rigid", "names"))
    episode.objects.push_back({without_slashes(name), {}});
  for (const Tool& tool : tools) episode.tools.push_back({without_slashes(tool.base), {}, {}, {}});

  const Array<double> q = file.read<double>("/q"), a = file.read<double>("/a"), T_link = file.read<double>("/T_link"),
                      T_rigid = file.read<double>("/T_rigid");
  const double h = file.number_attribute("/", "h");
  for (std::size_t f = 0; f < frame_step.size(); ++f) {
    const std::size_t step = std::size_t(frame_step[f]);
    const std::size_t next = f + 1 < frame_step.size() ? std::size_t(frame_step[f + 1]) : step;
    episode.state.push_back(sums(q, step, columns));
    episode.action.push_back(sums(a, next, columns));
    // of the last step; the first one has none before it and starts from rest
    std::vector<double> velocity(columns.size(), 0);
    if (step > 0) {
      const std::vector<double> before = sums(q, step - 1, columns);
      for (std::size_t i = 0; i < velocity.size(); ++i) velocity[i] = (episode.state.back()[i] - before[i]) / h;
    }
    episode.velocity.push_back(velocity);
    for (std::size_t i = 0; i < tools.size(); ++i) {
      const std::vector<Column> width = {{"", tools[i].joints, true}};
      episode.tools[i].pose.push_back(pose_at(T_link, step, tools[i].link) * tools[i].tool_center);
      episode.tools[i].width.push_back(sums(q, step, width)[0]);
      episode.tools[i].width_action.push_back(sums(a, next, width)[0]);
    }
    for (std::size_t i = 0; i < episode.objects.size(); ++i)
      episode.objects[i].pose.push_back(pose_at(T_rigid, step, i));
  }
  episode.cameras = read_cameras(folder, file, summary, cameras);
  return episode;
}

void demand_frames(const PackedCamera& camera, std::size_t n_frames, std::size_t n_pictures) {
  if (n_pictures != n_frames)
    throw Failure(camera.video.string() + " holds " + std::to_string(n_pictures) + " pictures, its episode " +
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
