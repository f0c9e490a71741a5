// The pictures of a video, by the program ffmpeg through a pipe; the counterpart of VideoWriter.
#pragma once
#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>

namespace pvg {

// Calls `take` with every picture in order, sRGB [height x width x 3]; returns how many there were. With a side > 0 it
// is the square in the middle of the picture, scaled to side x side.
std::size_t read_video(const std::filesystem::path& path, int width, int height, int side,
                       const std::function<void(std::span<const std::uint8_t> rgb)>& take);

}  // namespace pvg
