// Video by the program ffmpeg, fed through a pipe: H.264 (libx264), yuv420p, constant rate, no B-frames, index in
// front. The same frames give the same bytes. ffmpeg is only ever called, never linked.
#pragma once
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>

#include "host/base/error.hpp"

namespace pvg {

class ProgramPipe;

// Path of a program on PATH, or a UsageError that says which Debian package has it.
std::filesystem::path find_program(const std::string& program, const std::string& package);

// A UsageError about `what` unless width and height are even, which the colour format asks for.
void check_video_size(const std::string& what, int width, int height);

class VideoWriter {
 public:
  // rate [frames/s]; width and height as check_video_size wants them
  VideoWriter(const std::filesystem::path& path, int width, int height, double rate);
  ~VideoWriter();  // without finish(): what was begun is stopped and is no video
  VideoWriter(const VideoWriter&) = delete;

  // rgb: sRGB  [height x width x 3]
  void write(std::span<const std::uint8_t> rgb);
  // Waits until the file is complete.
  void finish();

 private:
  std::filesystem::path path_;
  std::size_t frame_bytes_;
  std::unique_ptr<ProgramPipe> ffmpeg_;
};

// One video of several that VideoWriter wrote with the same size and rate: their pictures, compressed as they are
// there. Errors name the last of them.
void join_videos(std::span<const std::filesystem::path> videos, const std::filesystem::path& to);

}  // namespace pvg
