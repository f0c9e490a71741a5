// Pictures for texturing, by OpenImageIO.
#pragma once
#include <filesystem>

#include "host/scene/scene.hpp"

namespace pvg {

// 8-bit sRGB with alpha (255 where the file has none); one channel becomes grey. UsageErrors name the file.
Texture read_texture(const std::filesystem::path& file);

}  // namespace pvg
