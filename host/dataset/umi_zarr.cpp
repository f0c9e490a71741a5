#include "host/dataset/umi_zarr.hpp"

#include <Eigen/Geometry>
#include <map>
#include <nlohmann/json.hpp>

#include "host/base/error.hpp"
#include "host/formats/stored_zip.hpp"

namespace pvg {
namespace {

using Shape = std::vector<std::uint64_t>;
using Json = nlohmann::ordered_json;

constexpr int SIDE = 224;  // [pixels]

// position, axis times angle
std::vector<float> pose_vector(const Eigen::Matrix4d& pose) {
  const Eigen::AngleAxisd turn(Eigen::Quaterniond(Eigen::Matrix3d(pose.topLeftCorner<3, 3>())).normalized());
  const Eigen::Vector3d rotation = turn.angle() * turn.axis();
  return {float(pose(0, 3)),   float(pose(1, 3)),   float(pose(2, 3)),
          float(rotation.x()), float(rotation.y()), float(rotation.z())};
}

std::vector<PackedCamera> chosen(const PackedEpisode& episode) {
  std::vector<PackedCamera> on_robots;
  for (const PackedCamera& camera : episode.cameras)
    if (camera.moves) on_robots.push_back(camera);
  return on_robots.empty() ? episode.cameras : on_robots;
}

class UmiZarrWriter : public DataSetWriter {
 public:
  explicit UmiZarrWriter(const std::filesystem::path& folder) : zip_(folder / "dataset.zarr.zip") {
    for (const char* group : {"", "data/", "meta/"})
      zip_.add(std::string(group) + ".zgroup", Json({{"zarr_format", 2}}).dump());
  }

  void add(const PackedEpisode& episode) override {
    if (episode.tools.empty())
      throw UsageError("episode " + std::to_string(episode.number) +
                       " has no gripper, which the layout of UMI is about");
    for (std::size_t i = 0; i < episode.tools.size(); ++i) add_robot("robot" + std::to_string(i), episode.tools[i]);
    const std::vector<PackedCamera> cameras = chosen(episode);
    n_cameras_ = cameras.size();
    for (std::size_t i = 0; i < cameras.size(); ++i) {
      std::size_t frame = n_frames_;
      const auto put = [&](std::span<const std::uint8_t> rgb) {
        zip_.add("data/camera" + std::to_string(i) + "_rgb/" + std::to_string(frame++) + ".0.0.0", rgb.data(),
                 rgb.size());
      };
      read_pictures(cameras[i], episode.n_frames(), SIDE, put);
    }
    n_frames_ += episode.n_frames();
    episode_ends_.push_back(std::int64_t(n_frames_));
  }

  void finish() override {
    for (const auto& [name, values] : series_) {
      const std::uint64_t width = values.size() / n_frames_;
      describe("data/" + name, {n_frames_, width}, {n_frames_, width}, "<f4");
      zip_.add("data/" + name + "/0.0", values.data(), values.size() * sizeof(float));
    }
    for (std::size_t i = 0; i < n_cameras_; ++i)
      describe("data/camera" + std::to_string(i) + "_rgb", {n_frames_, SIDE, SIDE, 3}, {1, SIDE, SIDE, 3}, "|u1");
    describe("meta/episode_ends", {episode_ends_.size()}, {episode_ends_.size()}, "<i8");
    zip_.add("meta/episode_ends/0", episode_ends_.data(), episode_ends_.size() * sizeof(std::int64_t));
    zip_.close();
  }

 private:
  void add_robot(const std::string& robot, const PackedTool& tool) {
    const auto append = [&](const std::string& name, std::span<const float> values) {
      std::vector<float>& to = series_[robot + "_" + name];
      to.insert(to.end(), values.begin(), values.end());
    };
    const std::vector<float> start = pose_vector(tool.pose.front()), end = pose_vector(tool.pose.back());
    for (std::size_t f = 0; f < tool.pose.size(); ++f) {
      const std::vector<float> pose = pose_vector(tool.pose[f]), width = {float(tool.width[f])};
      append("eef_pos", std::span(pose).first(3));
      append("eef_rot_axis_angle", std::span(pose).last(3));
      append("gripper_width", width);
      append("demo_start_pose", start);
      append("demo_end_pose", end);
    }
  }

  void describe(const std::string& name, const Shape& shape, const Shape& chunks, const char* type) {
    const Json array = {{"zarr_format", 2},      {"shape", shape},  {"chunks", chunks}, {"dtype", type},
                        {"compressor", nullptr}, {"fill_value", 0}, {"order", "C"},     {"filters", nullptr}};
    zip_.add(name + "/.zarray", array.dump());
  }

  StoredZip zip_;
  std::map<std::string, std::vector<float>> series_;  // [n_frames x width]
  std::size_t n_frames_ = 0, n_cameras_ = 0;
  std::vector<std::int64_t> episode_ends_;
};

}  // namespace

std::unique_ptr<DataSetWriter> make_umi_zarr_writer(const std::filesystem::path& folder) {
  return std::make_unique<UmiZarrWriter>(folder);
}

}  // namespace pvg
