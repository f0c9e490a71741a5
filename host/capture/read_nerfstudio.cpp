// nerfstudio's transforms.json: cameras of OpenGL (x right, y up, z back), depth in millimetres, registered to colour.
#include <nlohmann/json.hpp>

#include "host/base/error.hpp"
#include "host/base/files.hpp"
#include "host/base/outputs.hpp"
#include "host/capture/layouts.hpp"

namespace pvg {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
constexpr double LONGEST_EDGE = 16384;  // along an edge

double number_in(const json& frame, const json& root, const char* key, const fs::path& file) {
  const json& holder = frame.contains(key) ? frame : root;
  if (!holder.contains(key) || !holder[key].is_number())
    throw UsageError(file.string() + ": `" + key + "` is missing or no number, at the top or in a frame");
  return holder[key].get<double>();
}

int pixels_in(const json& frame, const json& root, const char* key, const fs::path& file) {
  const double number = number_in(frame, root, key, file);
  if (!(number >= 1 && number <= LONGEST_EDGE))
    throw UsageError(file.string() + ": `" + key + "` must be 1 to 16384 pixels");
  return int(number);
}

std::string text_in(const json& holder, const char* key, const std::string& otherwise, const fs::path& file) {
  if (!holder.contains(key)) return otherwise;
  if (!holder[key].is_string()) throw UsageError(file.string() + ": `" + key + "` is no text");
  return holder[key].get<std::string>();
}

Camera camera_of(const json& frame, const json& root, const fs::path& file) {
  Camera camera;
  camera.width = pixels_in(frame, root, "w", file);
  camera.height = pixels_in(frame, root, "h", file);
  camera.fx = number_in(frame, root, "fl_x", file);
  camera.fy = number_in(frame, root, "fl_y", file);
  // nerfstudio counts from the corner of the first pixel, OpenCV from its centre
  camera.cx = number_in(frame, root, "cx", file) - 0.5;
  camera.cy = number_in(frame, root, "cy", file) - 0.5;
  const std::string model = text_in(root, "camera_model", "OPENCV", file);
  const auto optional = [&](const char* key) {
    return frame.contains(key) || root.contains(key) ? number_in(frame, root, key, file) : 0.0;
  };
  if (model == "OPENCV_FISHEYE") {
    camera.model = Camera::Model::fisheye;
    camera.distortion = {optional("k1"), optional("k2"), optional("k3"), optional("k4")};
  } else if (model == "OPENCV" || model == "PINHOLE" || model == "SIMPLE_PINHOLE") {
    camera.distortion = {optional("k1"), optional("k2"), optional("p1"), optional("p2"), optional("k3")};
  } else {
    throw UsageError(file.string() + ": camera_model `" + model + "` is not read; OPENCV and OPENCV_FISHEYE are");
  }
  if (!frame.contains("transform_matrix") || !frame["transform_matrix"].is_array() ||
      frame["transform_matrix"].size() < 3)
    throw UsageError(file.string() + ": a frame has no `transform_matrix` of four rows: it has no pose");
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 4; ++j) {
      const json& row = frame["transform_matrix"][std::size_t(i)];
      if (!row.is_array() || row.size() != 4 || !row[std::size_t(j)].is_number())
        throw UsageError(file.string() + ": a `transform_matrix` holds something else than numbers");
      camera.pose.matrix()(i, j) = row[std::size_t(j)].get<double>() * (j == 1 || j == 2 ? -1 : 1);
    }
  return camera;
}

json root_of(const fs::path& file) {
  json root = json::parse(read_whole_file(file).value_or(""), nullptr, false);
  if (!root.is_object() || !root.contains("frames") || !root["frames"].is_array())
    throw UsageError(file.string() + " is no JSON mapping with a list `frames`");
  return root;
}

}  // namespace

bool is_nerfstudio(const fs::path& folder) { return is_file(folder / "transforms.json"); }

Capture read_nerfstudio(const fs::path& folder) {
  const fs::path file = folder / "transforms.json";
  const json root = root_of(file);
  Capture capture;
  for (const json& item : root["frames"]) {
    if (!item.is_object() || !item.contains("depth_file_path")) {
      capture.left_out.push_back(text_in(item, "file_path", "a frame without a name", file));
      continue;
    }
    CaptureFrame frame;
    frame.depth = folder / text_in(item, "depth_file_path", "", file);
    const std::string color = text_in(item, "file_path", "", file);
    if (!color.empty()) frame.color = folder / color;
    frame.name = frame.depth.stem().string();
    frame.depth_camera = frame.color_camera = camera_of(item, root, file);
    capture.frames.push_back(std::move(frame));
  }
  if (capture.frames.empty())
    throw UsageError(file.string() + ": no frame has `depth_file_path`; a room needs depth beside the photos");
  return capture;
}

std::vector<MaskedView> read_nerfstudio_masks(const fs::path& folder) {
  const fs::path file = folder / "transforms.json";
  const json root = root_of(file);
  std::vector<MaskedView> views;
  for (const json& item : root["frames"]) {
    if (!item.is_object() || !item.contains("mask_path")) continue;
    const fs::path mask = folder / text_in(item, "mask_path", "", file);
    views.push_back({mask.stem().string(), mask, camera_of(item, root, file)});
  }
  return views;
}

}  // namespace pvg
