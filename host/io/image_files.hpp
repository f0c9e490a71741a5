// Pictures: linear light to 8-bit sRGB, PNG files; linear light itself, EXR files.
#pragma once
#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "host/scene/scene.hpp"

namespace pvg {

// 8 bits per channel, sRGB, row 0 on top.
struct Image8 {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgb;  // [height x width x 3]
};

// IEC 61966-2-1: 12.92 c below 0.0031308, else 1.055 c^(1/2.4) - 0.055; cut to [0, 1], rounded to 1/255.
std::uint8_t srgb8_from_linear(float linear);
Image8 encode_srgb8(std::span<const float> linear_rgb, int width, int height);

// Suffix decides the format (.png). Throws a Failure that names the file.
void write_image(const std::filesystem::path& path, const Image8& image);
// linear_rgb: Rec. 709  [height x width x 3]. Suffix decides the format (.exr, .hdr).
void write_linear_image(const std::filesystem::path& path, std::span<const float> linear_rgb, int width, int height);
// A PNG file in memory, alpha included.
std::vector<std::uint8_t> encode_png(const Texture& texture);
Image8 read_image(const std::filesystem::path& path);

}  // namespace pvg
