// COLMAP's sparse model, binary or text, with depth maps of its dense stage or 16-bit pictures in depth/. Poses are
// camera from world, quaternion w first. The scale of a model from photos alone is arbitrary: the reader says so.
#include <algorithm>
#include <cstdint>
#include <cstring>
#include <map>
#include <sstream>

#include "host/base/error.hpp"
#include "host/base/files.hpp"
#include "host/base/outputs.hpp"
#include "host/capture/layouts.hpp"

namespace pvg {
namespace {

namespace fs = std::filesystem;

struct Model {
  const char* name;
  int id;
  std::size_t n;
};
constexpr Model MODELS[] = {{"SIMPLE_PINHOLE", 0, 3}, {"PINHOLE", 1, 4}, {"SIMPLE_RADIAL", 2, 4},
                            {"RADIAL", 3, 5},         {"OPENCV", 4, 8},  {"OPENCV_FISHEYE", 5, 8}};

struct Image {
  std::string name;
  std::uint32_t camera = 0;
  Pose pose;  // camera to world
};

fs::path model_folder(const fs::path& folder) {
  for (const char* inner : {"sparse/0", "sparse", "."})
    for (const char* ending : {".bin", ".txt"})
      if (is_file(folder / inner / (std::string("images") + ending))) return folder / inner;
  return {};
}

Camera camera_of(const Model& model, int width, int height, const std::vector<double>& p) {
  Camera camera;
  camera.width = width;
  camera.height = height;
  const bool has_two = model.id == 1 || model.id >= 4;
  const std::size_t at = has_two ? 2 : 1;
  camera.fx = p[0];
  camera.fy = p[has_two ? 1 : 0];
  camera.cx = p[at] - 0.5;  // COLMAP counts from the corner of the first pixel
  camera.cy = p[at + 1] - 0.5;
  if (model.id == 2) camera.distortion = {p[3], 0, 0, 0};
  if (model.id == 3) camera.distortion = {p[3], p[4], 0, 0};
  if (model.id >= 4) camera.distortion = {p[4], p[5], p[6], p[7]};
  if (model.id == 5) camera.model = Camera::Model::fisheye;
  return camera;
}

Pose pose_of(const double* q, const double* t, const fs::path& file) {
  const Eigen::Quaterniond rotation(q[0], q[1], q[2], q[3]);
  if (!(std::abs(rotation.norm() - 1) < 1e-2)) throw UsageError(file.string() + ": a quaternion has not length 1");
  Pose from_world = Pose::Identity();
  from_world.linear() = rotation.normalized().toRotationMatrix();
  from_world.translation() = Vec3(t[0], t[1], t[2]);
  return from_world.inverse();
}

const Model& model_of(const fs::path& file, const std::string& name, int id) {
  for (const Model& model : MODELS)
    if (id == model.id || name == model.name) return model;
  throw UsageError(file.string() + ": camera model `" + (name.empty() ? std::to_string(id) : name) +
                   "` is not read; undistort the images to PINHOLE");
}

// little endian; a UsageError where the file ends too early
struct Bytes {
  fs::path file;
  std::string content;
  std::size_t at = 0;
  template <typename T>
  T next() {
    if (content.size() - at < sizeof(T)) throw UsageError(file.string() + " ends too early; write it again");
    T value;
    std::memcpy(&value, content.data() + at, sizeof(T));
    at += sizeof(T);
    return value;
  }
  std::string text() {
    const std::size_t end = content.find('\0', at);
    if (end == std::string::npos) throw UsageError(file.string() + " ends within a name; write it again");
    std::string name = content.substr(at, end - at);
    at = end + 1;
    return name;
  }
};

std::map<std::uint32_t, Camera> read_cameras_bin(const fs::path& file) {
  Bytes in{file, read_whole_file(file).value_or("")};
  std::map<std::uint32_t, Camera> cameras;
  for (auto n = in.next<std::uint64_t>(); n-- > 0;) {
    const auto id = in.next<std::uint32_t>();
    const Model& model = model_of(file, "", in.next<std::int32_t>());
    const int width = int(in.next<std::uint64_t>()), height = int(in.next<std::uint64_t>());
    std::vector<double> p(model.n);
    for (double& x : p) x = in.next<double>();
    cameras[id] = camera_of(model, width, height, p);
  }
  return cameras;
}

std::vector<Image> read_images_bin(const fs::path& file) {
  Bytes in{file, read_whole_file(file).value_or("")};
  std::vector<Image> images;
  for (auto n = in.next<std::uint64_t>(); n-- > 0;) {
    in.next<std::uint32_t>();
    double q[4], t[3];
    for (double& x : q) x = in.next<double>();
    for (double& x : t) x = in.next<double>();
    Image image;
    image.pose = pose_of(q, t, file);
    image.camera = in.next<std::uint32_t>();
    image.name = in.text();
    const auto n_points = in.next<std::uint64_t>();
    if (n_points > (in.content.size() - in.at) / 24)
      throw UsageError(file.string() + " ends too early; write it again");
    in.at += n_points * 24;
    images.push_back(std::move(image));
  }
  return images;
}

std::vector<std::string> lines_of(const fs::path& file) {
  std::vector<std::string> lines;
  std::istringstream in(read_whole_file(file).value_or(""));
  for (std::string line; std::getline(in, line);)
    if (line.empty() || line[0] != '#') lines.push_back(line);
  return lines;
}

std::map<std::uint32_t, Camera> read_cameras_txt(const fs::path& file) {
  std::map<std::uint32_t, Camera> cameras;
  for (const std::string& line : lines_of(file)) {
    if (line.empty()) continue;
    std::istringstream in(line);
    std::uint32_t id = 0;
    std::string name;
    int width = 0, height = 0;
    in >> id >> name >> width >> height;
    const Model& model = model_of(file, name, -1);
    std::vector<double> p(model.n);
    for (double& x : p) in >> x;
    if (!in) throw UsageError(file.string() + ": `" + line + "` is no camera");
    cameras[id] = camera_of(model, width, height, p);
  }
  return cameras;
}

std::vector<Image> read_images_txt(const fs::path& file) {
  std::vector<Image> images;
  const std::vector<std::string> lines = lines_of(file);
  for (std::size_t i = 0; i < lines.size(); i += 2) {  // every second line holds the points that were seen
    if (lines[i].empty()) continue;
    std::istringstream in(lines[i]);
    std::uint32_t id = 0;
    double q[4] = {}, t[3] = {};
    Image image;
    in >> id >> q[0] >> q[1] >> q[2] >> q[3] >> t[0] >> t[1] >> t[2] >> image.camera >> image.name;
    if (!in) throw UsageError(file.string() + ": `" + lines[i].substr(0, 60) + "` is no image");
    image.pose = pose_of(q, t, file);
    images.push_back(std::move(image));
  }
  return images;
}

// the places of the model's points
std::vector<Vec3> read_points_bin(const fs::path& file) {
  Bytes in{file, read_whole_file(file).value_or("")};
  std::vector<Vec3> points;
  for (auto n = in.next<std::uint64_t>(); n-- > 0;) {
    in.next<std::uint64_t>();
    Vec3& p = points.emplace_back();
    for (double& x : p) x = in.next<double>();
    for (int channel = 0; channel < 3; ++channel) in.next<std::uint8_t>();
    in.next<double>();
    const auto n_seen = in.next<std::uint64_t>();
    if (n_seen > (in.content.size() - in.at) / 8) throw UsageError(file.string() + " ends too early; write it again");
    in.at += n_seen * 8;
  }
  return points;
}

std::vector<Vec3> read_points_txt(const fs::path& file) {
  std::vector<Vec3> points;
  for (const std::string& line : lines_of(file)) {
    if (line.empty()) continue;
    std::istringstream in(line);
    std::uint64_t id = 0;
    Vec3& p = points.emplace_back();
    in >> id >> p.x() >> p.y() >> p.z();
    if (!in) throw UsageError(file.string() + ": `" + line.substr(0, 60) + "` is no point");
  }
  return points;
}

std::vector<Vec3> read_points(const fs::path& model) {
  for (const bool is_binary : {true, false}) {
    const fs::path file = model / (is_binary ? "points3D.bin" : "points3D.txt");
    if (is_file(file)) return is_binary ? read_points_bin(file) : read_points_txt(file);
  }
  throw UsageError((model / "points3D.bin").string() +
                   " is missing: its points tell how the mesh beside the model lies among the photos");
}

// Map-Anything's dense_mesh.glb, or the only GLB of the folder; empty: there is none
fs::path mesh_beside(const fs::path& folder) {
  if (is_file(folder / "dense_mesh.glb")) return folder / "dense_mesh.glb";
  std::vector<fs::path> meshes;
  for (const auto& entry : fs::directory_iterator(folder))
    if (entry.is_regular_file() && entry.path().extension() == ".glb") meshes.push_back(entry.path());
  if (meshes.size() > 1)
    throw UsageError(folder.string() + ": it holds several .glb files and no depth maps; leave the one to be taken");
  return meshes.empty() ? fs::path() : meshes.front();
}

// empty: there is none
fs::path depth_file_of(const fs::path& folder, const std::string& name) {
  const std::string stem = fs::path(name).replace_extension().string();
  for (const fs::path& file : {folder / "stereo/depth_maps" / (name + ".geometric.bin"),
                               folder / "depth" / (stem + ".png"), folder / "depth" / (stem + ".exr")})
    if (is_file(file)) return file;
  return {};
}

}  // namespace

bool is_colmap(const fs::path& folder) { return !model_folder(folder).empty(); }

Capture read_colmap(const fs::path& folder) {
  const fs::path model = model_folder(folder);
  const bool is_binary = is_file(model / "images.bin");
  const fs::path camera_file = model / (is_binary ? "cameras.bin" : "cameras.txt");
  if (!is_file(camera_file)) throw UsageError(camera_file.string() + " is missing beside the images' poses");
  const auto cameras = is_binary ? read_cameras_bin(camera_file) : read_cameras_txt(camera_file);
  const auto images = is_binary ? read_images_bin(model / "images.bin") : read_images_txt(model / "images.txt");
  Capture capture;
  for (const Image& image : images) {
    CaptureFrame frame;
    frame.name = image.name;
    frame.depth = depth_file_of(folder, image.name);
    frame.color = folder / "images" / image.name;
    if (!is_file(frame.color)) frame.color.clear();
    if (frame.depth.empty() && frame.color.empty()) {
      capture.left_out.push_back(image.name);
      continue;
    }
    const auto camera = cameras.find(image.camera);
    if (camera == cameras.end())
      throw UsageError((model / "images").string() + ": " + image.name + " names a camera that is not there");
    frame.depth_camera = camera->second;
    frame.depth_camera.pose = image.pose;
    frame.color_camera = frame.depth_camera;
    if (frame.depth.extension() == ".bin") capture.depth_unit = 1;
    capture.frames.push_back(std::move(frame));
  }
  const auto has_no_depth = [](const CaptureFrame& frame) { return frame.depth.empty(); };
  if (!std::all_of(capture.frames.begin(), capture.frames.end(), has_no_depth)) {
    for (const CaptureFrame& frame : capture.frames)
      if (has_no_depth(frame)) capture.left_out.push_back(frame.name);
    std::erase_if(capture.frames, has_no_depth);
    return capture;
  }
  capture.mesh = mesh_beside(folder);
  if (capture.mesh.empty() || capture.frames.empty())
    throw UsageError(folder.string() +
                     ": no image has a depth map (stereo/depth_maps/NAME.geometric.bin or depth/NAME.png), and no mesh "
                     "lies beside them; points alone make no surface: give depth maps, or a dense_mesh.glb as "
                     "Map-Anything writes with --save_glb");
  capture.points = read_points(model);
  return capture;
}

}  // namespace pvg
