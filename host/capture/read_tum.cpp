// The layout of the TUM RGB-D benchmark. Colour is registered to depth; lists are matched by time.
#include <cmath>
#include <fstream>
#include <sstream>

#include "host/base/error.hpp"
#include "host/base/outputs.hpp"
#include "host/capture/layouts.hpp"

namespace pvg {
namespace {

namespace fs = std::filesystem;

constexpr double LARGEST_GAP = 0.02;       // between stamps that belong together [s]
constexpr double DEPTH_UNIT = 1 / 5000.0;  // [m]

struct Stamped {
  double time = 0;
  std::string file;
};

std::vector<Stamped> read_list_file(const fs::path& file) {
  std::vector<Stamped> list;
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);) {
    std::istringstream words(line);
    Stamped item;
    if (line.empty() || line[0] == '#') continue;
    if (!(words >> item.time >> item.file)) throw UsageError(file.string() + ": `" + line + "` is no time and file");
    list.push_back(item);
  }
  return list;
}

// index of the row nearest in time; -1: none is near
template <typename Time>
int nearest(std::size_t n, double time, Time time_of) {
  int best = -1;
  for (std::size_t i = 0; i < n; ++i)
    if (std::abs(time_of(i) - time) <= LARGEST_GAP &&
        (best < 0 || std::abs(time_of(i) - time) < std::abs(time_of(std::size_t(best)) - time)))
      best = int(i);
  return best;
}

}  // namespace

bool is_tum(const fs::path& folder) { return is_file(folder / "depth.txt") && is_file(folder / "groundtruth.txt"); }

Capture read_tum(const fs::path& folder) {
  const fs::path optics = folder / "camera.txt";
  if (!is_file(optics))
    throw UsageError(optics.string() +
                     " is missing: `fx fy cx cy`, and optionally OpenCV's distortion, of both pictures; the TUM page "
                     "lists them per camera");
  const std::vector<double> k = numbers_in(optics);
  if (k.size() != 4 && k.size() != 8 && k.size() != 9)
    throw UsageError(optics.string() + ": must hold fx fy cx cy, then nothing or 4 or 5 numbers of distortion");
  const fs::path truth = folder / "groundtruth.txt";
  const std::vector<double> poses = numbers_in(truth);  // eight per row
  if (poses.size() % 8 != 0 || poses.empty())
    throw UsageError(truth.string() + ": each line is a time, a position and a quaternion x y z w, 8 numbers");
  const std::vector<Stamped> depth = read_list_file(folder / "depth.txt");
  std::vector<Stamped> color;
  if (is_file(folder / "rgb.txt")) color = read_list_file(folder / "rgb.txt");
  Capture capture;
  capture.depth_unit = DEPTH_UNIT;
  for (const Stamped& item : depth) {
    const int row = nearest(poses.size() / 8, item.time, [&](std::size_t i) { return poses[8 * i]; });
    if (row < 0) {
      capture.left_out.push_back(item.file);
      continue;
    }
    const double* p = &poses[8 * std::size_t(row)];
    CaptureFrame frame;
    frame.name = fs::path(item.file).stem().string();
    frame.depth = folder / item.file;
    const int seen = nearest(color.size(), item.time, [&](std::size_t i) { return color[i].time; });
    if (seen >= 0) frame.color = folder / color[std::size_t(seen)].file;
    Camera& camera = frame.depth_camera;
    camera.fx = k[0];
    camera.fy = k[1];
    camera.cx = k[2];
    camera.cy = k[3];
    camera.distortion.assign(k.begin() + 4, k.end());
    const Eigen::Quaterniond q(p[7], p[4], p[5], p[6]);
    if (!(std::abs(q.norm() - 1) < 1e-2))
      throw UsageError(truth.string() + ": the quaternion at time " + std::to_string(p[0]) + " has not length 1");
    camera.pose = Pose::Identity();
    camera.pose.linear() = q.normalized().toRotationMatrix();
    camera.pose.translation() = Vec3(p[1], p[2], p[3]);
    set_size_of(frame.depth, camera);
    frame.color_camera = camera;
    if (!frame.color.empty()) set_size_of(frame.color, frame.color_camera);
    capture.frames.push_back(std::move(frame));
  }
  return capture;
}

}  // namespace pvg
