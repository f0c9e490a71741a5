#include "host/dataset/robomimic_file.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <nlohmann/json.hpp>

#include "host/hdf5/series.hpp"

namespace pvg {
namespace {

using hdf5::Series;

constexpr std::size_t EACH_FOR_VALIDATION = 10;

Rows shifted(Rows rows) {
  rows.erase(rows.begin());
  rows.push_back(rows.back());
  return rows;
}

Rows flat_poses(const std::vector<Eigen::Matrix4d>& poses) {
  Rows rows;
  for (const Eigen::Matrix4d& pose : poses) {
    const Eigen::Matrix<double, 4, 4, Eigen::RowMajor> by_row = pose;
    rows.emplace_back(by_row.data(), by_row.data() + 16);
  }
  return rows;
}

Rows column(const std::vector<double>& values) {
  Rows rows;
  for (const double value : values) rows.push_back({value});
  return rows;
}

void write_rows(hdf5::File& file, const std::string& name, const Rows& rows, hdf5::Shape row = {}) {
  std::vector<double> values;
  for (const std::vector<double>& each : rows) values.insert(values.end(), each.begin(), each.end());
  if (row.empty()) row = {rows.front().size()};
  row.insert(row.begin(), rows.size());
  file.write<double>(name, row, values);
}

class RobomimicWriter : public DataSetWriter {
 public:
  RobomimicWriter(const std::filesystem::path& folder, const PackedSet& set)
      : file_(hdf5::File::create(folder / "demo.hdf5")), n_frames_(set.n_frames) {
    file_.make_group("/data");
    for (std::size_t i = 0; i < set.least_action.size(); ++i) {
      const double half = 0.5 * (set.most_action[i] - set.least_action[i]);
      offset_.push_back(0.5 * (set.most_action[i] + set.least_action[i]));
      scale_.push_back(half > 0 ? half : 1);  // what never moves is 0 throughout
    }
  }

  void add(const PackedEpisode& episode) override {
    if (n_written_ == 0) write_head(episode);
    const std::string demo = "/data/demo_" + std::to_string(n_written_++);
    Rows actions = episode.action, states = episode.state;
    for (std::vector<double>& action : actions)
      for (std::size_t i = 0; i < action.size(); ++i)
        action[i] = std::clamp((action[i] - offset_[i]) / scale_[i], -1.0, 1.0);
    for (const PackedObject& object : episode.objects)
      for (std::size_t f = 0; f < states.size(); ++f) {
        const std::vector<double> pose = flat_poses({object.pose[f]})[0];
        states[f].insert(states[f].end(), pose.begin(), pose.begin() + 12);
      }
    write_rows(file_, demo + "/actions", actions);
    write_rows(file_, demo + "/actions_abs", episode.action);
    std::vector<double> at_end(episode.n_frames(), 0);
    at_end.back() = 1;
    file_.write<double>(demo + "/rewards", {at_end.size()}, at_end);
    file_.write<std::int64_t>(demo + "/dones", {at_end.size()},
                              std::vector<std::int64_t>(at_end.begin(), at_end.end()));
    write_rows(file_, demo + "/states", states);
    write_observations(demo + "/obs", episode, false);
    write_observations(demo + "/next_obs", episode, true);
    if (!episode.tools.empty()) write_datagen_info(demo + "/datagen_info", episode);
    file_.attribute(demo, "num_samples", std::int64_t(episode.n_frames()));
    file_.attribute(demo, "episode", std::int64_t(episode.number));
  }

  void finish() override {
    std::vector<std::string> train, valid;
    for (std::size_t i = 0; i < n_written_; ++i) {
      // at least one is for validation, unless there is only one
      const bool is_valid = n_written_ > 1 && (i % EACH_FOR_VALIDATION == EACH_FOR_VALIDATION - 1 ||
                                               (n_written_ < EACH_FOR_VALIDATION && i + 1 == n_written_));
      (is_valid ? valid : train).push_back("demo_" + std::to_string(i));
    }
    file_.write_texts("/mask/train", train);
    file_.write_texts("/mask/valid", valid);
    file_.close();
  }

 private:
  void write_head(const PackedEpisode& episode) {
    // type 1: an environment in the manner of Gym
    const nlohmann::ordered_json env = {{"env_name", episode.task},
                                        {"type", 1},
                                        {"env_type", 1},
                                        {"env_kwargs", {{"frames_per_second", episode.frames_per_second}}}};
    file_.attribute("/data", "total", std::int64_t(n_frames_));
    file_.attribute("/data", "env_args", env.dump());
    file_.attribute("/data", "action_names", episode.columns);
    file_.write<double>("/action_offset", {offset_.size()}, offset_);
    file_.write<double>("/action_scale", {scale_.size()}, scale_);
  }

  void write_observations(const std::string& group, const PackedEpisode& episode, bool is_next) {
    const auto put = [&](const std::string& name, const Rows& rows) {
      write_rows(file_, group + "/" + name, is_next ? shifted(rows) : rows);
    };
    put("robot0_joint_pos", episode.state);
    put("robot0_joint_vel", episode.velocity);
    for (std::size_t i = 0; i < episode.tools.size(); ++i) {
      const std::string robot = "robot" + std::to_string(i) + "_";
      Rows positions, quaternions;
      for (const Eigen::Matrix4d& pose : episode.tools[i].pose) {
        const Eigen::Quaterniond q(Eigen::Matrix3d(pose.topLeftCorner<3, 3>()));
        positions.push_back({pose(0, 3), pose(1, 3), pose(2, 3)});
        quaternions.push_back({q.x(), q.y(), q.z(), q.w()});
      }
      put(robot + "eef_pos", positions);
      put(robot + "eef_quat", quaternions);
      put(robot + "gripper_qpos", column(episode.tools[i].width));
    }
    for (const PackedCamera& camera : episode.cameras) {
      Series<std::uint8_t> pictures(file_, group + "/" + camera.name + "_image",
                                    {std::uint64_t(camera.height), std::uint64_t(camera.width), 3});
      std::vector<std::uint8_t> last;
      std::size_t n = 0;
      read_pictures(camera, episode.n_frames(), 0, [&](auto rgb) {
        if (!is_next || n++ > 0) pictures.append(rgb);
        last.assign(rgb.begin(), rgb.end());
      });
      if (is_next) pictures.append(last);
    }
  }

  void write_datagen_info(const std::string& group, const PackedEpisode& episode) {
    const Rows poses = flat_poses(episode.tools[0].pose);
    write_rows(file_, group + "/eef_pose", poses, {4, 4});
    write_rows(file_, group + "/target_pose", shifted(poses), {4, 4});
    write_rows(file_, group + "/gripper_action", column(episode.tools[0].width_action));
    file_.make_group(group + "/object_poses");
    for (const PackedObject& object : episode.objects)
      write_rows(file_, group + "/object_poses/" + object.name, flat_poses(object.pose), {4, 4});
  }

  hdf5::File file_;
  std::size_t n_frames_, n_written_ = 0;
  std::vector<double> offset_, scale_;
};

}  // namespace

std::unique_ptr<DataSetWriter> make_robomimic_writer(const std::filesystem::path& folder, const PackedSet& set) {
  return std::make_unique<RobomimicWriter>(folder, set);
}

}  // namespace pvg
