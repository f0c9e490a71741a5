// Readers of one layout each; read_capture.cpp lists them. Internal to host/capture. Layouts: 7-Scenes, TUM RGB-D,
// nerfstudio, COLMAP.
#pragma once
#include "host/capture/frames.hpp"

namespace pvg {

// frame-N.depth.png, frame-N.color.jpg or .png, frame-N.pose.txt (4 x 4, camera to world), camera-intrinsics.txt
bool is_seven_scenes(const std::filesystem::path& folder);
Capture read_seven_scenes(const std::filesystem::path& folder);

// depth.txt, rgb.txt (time file), groundtruth.txt (time tx ty tz qx qy qz qw), camera.txt (fx fy cx cy)
bool is_tum(const std::filesystem::path& folder);
Capture read_tum(const std::filesystem::path& folder);

// transforms.json with depth_file_path or mask_path in its frames; cameras of OpenGL
bool is_nerfstudio(const std::filesystem::path& folder);
Capture read_nerfstudio(const std::filesystem::path& folder);
std::vector<MaskedView> read_nerfstudio_masks(const std::filesystem::path& folder);

// sparse/[0/]{cameras,images}.{bin,txt}, images/, stereo/depth_maps/NAME.geometric.bin or depth/STEM.png
bool is_colmap(const std::filesystem::path& folder);
Capture read_colmap(const std::filesystem::path& folder);

// Numbers of a text file, `#` begins a comment; a UsageError names the file where something else stands in it.
std::vector<double> numbers_in(const std::filesystem::path& file);
// The size of a picture without reading it all.
void set_size_of(const std::filesystem::path& picture, Camera& camera);

}  // namespace pvg
