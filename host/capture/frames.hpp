// What a capture consists of: pictures of depth and colour whose poses are known.
#pragma once
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "host/formats/depth_files.hpp"
#include "host/geometry/visual_mesh.hpp"
#include "host/model/appearance.hpp"
#include "host/pictures/picture.hpp"

namespace pvg {

struct CaptureFrame {
  std::string name;                                 // for messages, such as "frame-000020"
  std::filesystem::path color, depth;               // files; color may be empty, depth where it was drawn
  std::shared_ptr<const DepthPicture> drawn_depth;  // of a mesh, instead of a file (meshes/room_mesh.hpp)
  Camera depth_camera, color_camera;                // optics, and pose: camera to the capture's frame
};

struct Capture {
  std::string layout;  // name of the layout that was found
  std::vector<CaptureFrame> frames;
  std::vector<std::string> left_out;  // names of frames that lack depth or a finite pose
  double depth_unit = 1e-3;           // of a file's numbers [m]
  // depth and colour are of two sensors whose relative pose the files do not give
  bool colors_are_apart = false;
  // A mesh beside photos without depth, and points in the capture's frame that lie on it: draw_depths
  // (meshes/room_mesh.hpp) makes the frames' depths of it.
  std::filesystem::path mesh;
  std::vector<Vec3> points;
};

// What is seen of what was captured.
struct CapturedSurface {
  VisualMesh mesh;
  Texture texture;  // empty: the mesh's colours are all there is
};

// Finds the layout by the files in `folder`; names those that it knows where none fits. Poses are checked:
// rotations orthonormal within 1e-3 (and then made so), cameras near each other. depth_unit: overrides the layout's
// [m]; 0: the layout's. UsageErrors name file and frame.
Capture read_capture(const std::filesystem::path& folder, double depth_unit = 0);

// A photo in which someone marked a thing.
struct MaskedView {
  std::string name;            // for messages
  std::filesystem::path mask;  // file: the thing is where it is at least half bright
  Camera camera;               // optics, and pose: camera to the capture's frame
};

// The frames of nerfstudio's transforms.json that have a `mask_path`. Poses and cameras are checked as above.
// UsageErrors name the file.
std::vector<MaskedView> read_masked_views(const std::filesystem::path& folder);

// The picture of depth of a frame, checked against the camera's size.
DepthPicture depth_of(const Capture& capture, const CaptureFrame& frame);
Picture8 color_of(const CaptureFrame& frame);

// One sentence where the depths cannot be metres: median beyond 0.1 to 20 m. Throws a UsageError.
void check_depth_scale(const Capture& capture, const CaptureFrame& frame, const DepthPicture& picture);

}  // namespace pvg
