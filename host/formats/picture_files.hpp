// Picture files: 8-bit sRGB as PNG, linear light as EXR.
#pragma once
#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "host/pictures/picture.hpp"

namespace pvg {

// Suffix decides the format (.png). Throws a Failure that names the file.
void write_picture(const std::filesystem::path& path, const Picture8& picture);
// linear_rgb: Rec. 709  [height x width x 3]. Suffix decides the format (.exr, .hdr).
void write_linear_picture(const std::filesystem::path& path, std::span<const float> linear_rgb, int width, int height);
// A PNG file in memory, alpha included.
std::vector<std::uint8_t> encode_png(const Texture& texture);
Picture8 read_picture(const std::filesystem::path& path);

struct Mask8 {
  int width = 0, height = 0;
  std::vector<std::uint8_t> pixels;  // 1: the part, 0: not  [height x width]
};
// A picture of a mask: the part is where its first channel is at least half of full.
Mask8 read_mask_picture(const std::filesystem::path& path);

}  // namespace pvg
