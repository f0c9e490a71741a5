// Video by the program ffmpeg, fed through a pipe: H.264 (libx264), yuv420p, constant rate, no B-frames, index in
// front. The same frames give the same bytes. ffmpeg is only ever called, never linked.
#pragma once
#include <sys/types.h>

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

#include "host/base/error.hpp"

namespace pvg {

// Path of a program on PATH, or a UsageError that says which Debian package has it.
std::filesystem::path find_program(const std::string& program, const std::string& package);

class VideoWriter {
 public:
  // rate [frames/s]; width and height must be even, which the colour format asks for
  VideoWriter(const std::filesystem::path& path, int width, int height, double rate);
  ~VideoWriter();  // without finish(): what was begun is stopped and is no video
  VideoWriter(const VideoWriter&) = delete;

  // rgb: sRGB  [height x width x 3]
  void write(std::span<const std::uint8_t> rgb);
  // Waits until the file is complete.
  void finish();

 private:
  std::string end();  // closes the pipe, waits for ffmpeg, returns the first thing it had to complain about
  std::filesystem::path path_;
  std::size_t frame_bytes_;
  int frames_ = -1, messages_ = -1;  // file descriptors: frames to ffmpeg, complaints from it
  pid_t child_ = -1;
  bool has_failed_ = false;
};

}  // namespace pvg
