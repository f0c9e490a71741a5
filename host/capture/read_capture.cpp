#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <sstream>

#include "host/base/counted.hpp"
#include "host/base/error.hpp"
#include "host/base/files.hpp"
#include "host/base/notes.hpp"
#include "host/base/statistics.hpp"
#include "host/capture/layouts.hpp"
#include "host/formats/picture_files.hpp"
#include "host/render/camera.hpp"

namespace pvg {
namespace {

namespace fs = std::filesystem;

struct Layout {
  const char* name;
  bool (*is_it)(const fs::path&);
  Capture (*read)(const fs::path&);
};

constexpr Layout LAYOUTS[] = {{"7-Scenes", is_seven_scenes, read_seven_scenes},
                              {"TUM RGB-D", is_tum, read_tum},
                              {"nerfstudio", is_nerfstudio, read_nerfstudio},
                              {"COLMAP", is_colmap, read_colmap}};

constexpr double ROTATION_TOLERANCE = 1e-2;  // of R^T R - 1; files round their numbers
constexpr double MOST_SPREAD = 100;          // of the cameras of a room [m]; poses in millimetres are beyond it
constexpr std::size_t MOST_NAMED = 3;        // of the frames that are left out

// makes the rotation orthonormal
void check_pose(const fs::path& folder, Camera& camera) {
  const Eigen::Matrix4d m = camera.pose.matrix();
  const std::string where = folder.string() + ": the pose of " + camera.name;
  if (!m.allFinite()) throw UsageError(where + " is not finite; leave the frame out or track it again");
  const Eigen::Matrix3d R = m.topLeftCorner<3, 3>();
  if (!((R.transpose() * R - Eigen::Matrix3d::Identity()).norm() < ROTATION_TOLERANCE))
    throw UsageError(where + " is no rotation and translation: it scales or shears; poses must be rigid");
  if (!(R.determinant() > 0)) throw UsageError(where + " mirrors; poses must be right-handed");
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(R, Eigen::ComputeFullU | Eigen::ComputeFullV);
  camera.pose.linear() = svd.matrixU() * svd.matrixV().transpose();
}

// Where tracking was lost, some programs write a pose of infinities or NaN instead of none.
void leave_out_lost(Capture& capture) {
  const auto is_lost = [](const CaptureFrame& frame) { return !frame.depth_camera.pose.matrix().allFinite(); };
  for (const CaptureFrame& frame : capture.frames)
    if (is_lost(frame)) capture.left_out.push_back(frame.name);
  std::erase_if(capture.frames, is_lost);
}

void check_spread(const fs::path& folder, const Capture& capture) {
  Eigen::AlignedBox3d cameras;
  for (const CaptureFrame& frame : capture.frames) cameras.extend(frame.depth_camera.pose.translation());
  if (const double spread = cameras.sizes().maxCoeff(); spread > MOST_SPREAD)
    throw UsageError(fmt::format(
        "{}: its cameras are up to {:.0f} m apart, more than the {:.0f} m of a room; poses must be in metres, so scale "
        "their positions, or leave out where tracking went astray",
        folder.string(), spread, MOST_SPREAD));
}

void tell_left_out(const fs::path& folder, const Capture& capture) {
  if (capture.left_out.empty()) return;
  const std::size_t n = capture.left_out.size(), n_named = std::min(n, MOST_NAMED);
  const auto first = capture.left_out.begin();
  tell_note(fmt::format("{}: {} of {} {} left out: {}{}", folder.string(), n,
                        counted(n + capture.frames.size(), "frame"),
                        n == 1 ? "lacks depth or a finite pose and is" : "lack depth or a finite pose and are",
                        fmt::join(first, first + std::ptrdiff_t(n_named), ", "), n > n_named ? ", ..." : ""));
}

}  // namespace

Capture read_capture(const fs::path& folder, double depth_unit) {
  if (!fs::exists(folder)) throw UsageError(folder.string() + ": there is no such folder of frames or mesh");
  if (!fs::is_directory(folder))
    throw UsageError(folder.string() + " is neither a folder of frames nor a mesh (.glb, .gltf, .ply, .obj)");
  for (const Layout& layout : LAYOUTS) {
    if (!layout.is_it(folder)) continue;
    Capture capture = layout.read(folder);
    capture.layout = layout.name;
    if (depth_unit > 0) capture.depth_unit = depth_unit;
    leave_out_lost(capture);
    if (capture.frames.empty())
      throw UsageError(folder.string() + ": no frame of this " + layout.name +
                       " folder has both depth and a finite pose");
    for (CaptureFrame& frame : capture.frames) {
      frame.depth_camera.name = frame.color_camera.name = frame.name;
      check_pose(folder, frame.depth_camera);
      check_pose(folder, frame.color_camera);
      check_camera(frame.depth_camera);
      check_camera(frame.color_camera);
    }
    check_spread(folder, capture);
    tell_left_out(folder, capture);
    return capture;
  }
  throw UsageError(folder.string() +
                   " is no capture: it holds no frame-N.depth.png beside frame-N.pose.txt (7-Scenes), no depth.txt "
                   "beside groundtruth.txt (TUM), no transforms.json (nerfstudio) and no sparse/ (COLMAP)");
}

std::vector<MaskedView> read_masked_views(const fs::path& folder) {
  if (!is_nerfstudio(folder))
    throw UsageError(folder.string() +
                     " holds no transforms.json (nerfstudio), which says where each mask was seen from");
  std::vector<MaskedView> views = read_nerfstudio_masks(folder);
  for (MaskedView& view : views) {
    view.camera.name = view.name;
    check_pose(folder, view.camera);
    check_camera(view.camera);
  }
  return views;
}

DepthPicture depth_of(const Capture& capture, const CaptureFrame& frame) {
  if (frame.drawn_depth) return *frame.drawn_depth;
  DepthPicture picture = read_depth_picture(frame.depth, capture.depth_unit);
  const Camera& camera = frame.depth_camera;
  if (picture.width != camera.width || picture.height != camera.height)
    throw UsageError(frame.depth.string() + " has " + std::to_string(picture.width) + " x " +
                     std::to_string(picture.height) + " pixels, its camera " + std::to_string(camera.width) + " x " +
                     std::to_string(camera.height) + "; give the intrinsics of this size");
  return picture;
}

Picture8 color_of(const CaptureFrame& frame) {
  Picture8 picture = read_picture(frame.color);
  if (picture.width != frame.color_camera.width || picture.height != frame.color_camera.height)
    throw UsageError(frame.color.string() + " has another size than its camera");
  return picture;
}

void check_depth_scale(const Capture& capture, const CaptureFrame& frame, const DepthPicture& picture) {
  std::vector<float> depths;
  for (const float z : picture.depth)
    if (z > 0) depths.push_back(z);
  if (depths.empty()) return;  // a covered sensor; other frames say more
  const double median = upper_median(std::move(depths));
  if (median < 0.1 || median > 20)
    throw UsageError(frame.depth.string() + ": half of its depths are " + (median < 0.1 ? "below " : "above ") +
                     std::to_string(median) + " m with " + std::to_string(capture.depth_unit) +
                     " m per unit; give the unit with --depth-unit (1 of files in metres, 0.001 in millimetres)");
}

// what several layouts need
std::vector<double> numbers_in(const std::filesystem::path& file) {
  const auto content = read_whole_file(file);
  if (!content) throw UsageError(file.string() + " cannot be read");
  std::vector<double> numbers;
  std::istringstream lines(*content);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line.substr(0, line.find('#')));
    for (std::string word; words >> word;) {
      char* end = nullptr;
      numbers.push_back(std::strtod(word.c_str(), &end));
      if (end == word.c_str() || *end != 0)
        throw UsageError(file.string() + ": `" + word.substr(0, 40) + "` is no number");
    }
  }
  return numbers;
}

void set_size_of(const std::filesystem::path& picture, Camera& camera) {
  const PictureSize size = picture_size(picture);
  camera.width = size.width;
  camera.height = size.height;
}

}  // namespace pvg
