// Pictures for texturing, by OpenImageIO.
#pragma once
#include <filesystem>

#include "host/pictures/picture.hpp"

namespace pvg {

// 8-bit sRGB with alpha (255 where the file has none); one channel becomes grey. UsageErrors name the file.
Texture read_texture(const std::filesystem::path& file);

// The same of a file that is in memory; `name` is for messages.
Texture unpack_texture(const std::vector<unsigned char>& bytes, const std::string& name);

// An equirectangular picture of the surroundings: linear values of .hdr and .exr files; 8-bit ones are decoded as sRGB.
EnvironmentMap read_environment(const std::filesystem::path& file);

}  // namespace pvg
