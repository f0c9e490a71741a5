// Pictures of depth along the optical axis, and how large a picture is.
#pragma once
#include <filesystem>
#include <vector>

namespace pvg {

struct DepthPicture {
  int width = 0, height = 0;
  std::vector<float> depth;  // [height x width, m]; 0: none
};

// 16-bit PNG of which one unit is `unit` metres (0 and 65535: none), .exr or .tif of floats likewise, and COLMAP's
// .bin (text `width&height&channels&`, then float32). What is not finite or not positive is none. UsageErrors name the
// file.
DepthPicture read_depth_picture(const std::filesystem::path& file, double unit);

// 16-bit PNG in units of `unit` [m]; what is beyond 65534 units becomes 0: none.
void write_depth_picture(const std::filesystem::path& file, const DepthPicture& picture, double unit);

struct PictureSize {
  int width = 0, height = 0;  // [pixels]
};

// Of a picture of any kind, without reading all of it.
PictureSize picture_size(const std::filesystem::path& file);

}  // namespace pvg
