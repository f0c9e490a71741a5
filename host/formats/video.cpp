#include "host/formats/video.hpp"

#include <fmt/format.h>

#include <unistd.h>

#include <cstdlib>
#include <sstream>
#include <vector>

#include "host/base/program_pipe.hpp"

namespace pvg {
namespace {

std::vector<std::string> ffmpeg_arguments(const std::filesystem::path& path, int width, int height, double rate) {
  return {"-hide_banner", "-loglevel", "error", "-y",
          // what comes in
          "-f", "rawvideo", "-pix_fmt", "rgb24", "-video_size", std::to_string(width) + "x" + std::to_string(height),
          "-framerate", fmt::format("{:.12g}", rate), "-i", "pipe:0",
          // sRGB to the colours of HD video, exactly rounded; the file says so
          "-vf", "scale=flags=accurate_rnd+full_chroma_int+bitexact:out_color_matrix=bt709:out_range=tv", "-pix_fmt",
          "yuv420p", "-colorspace", "bt709", "-color_primaries", "bt709", "-color_trc", "bt709", "-color_range", "tv",
          // one thread and no version texts: the same bytes from the same frames
          "-c:v", "libx264", "-preset", "medium", "-crf", "18", "-bf", "0", "-g", "10", "-threads", "1", "-fflags",
          "+bitexact", "-flags:v", "+bitexact", "-map_metadata", "-1", "-movflags", "+faststart", "-f", "mp4",
          // a path that begins with a dash is no option
          "file:" + path.string()};
}

}  // namespace

std::filesystem::path find_program(const std::string& program, const std::string& package) {
  const char* folders = std::getenv("PATH");
  std::istringstream list(folders ? folders : "");
  for (std::string folder; std::getline(list, folder, ':');) {
    const std::filesystem::path path = std::filesystem::path(folder.empty() ? "." : folder) / program;
    std::error_code ignored;
    if (access(path.c_str(), X_OK) == 0 && std::filesystem::is_regular_file(path, ignored)) return path;
  }
  throw UsageError("the program " + program + " was not found on PATH; install it (Debian package " + package + ")");
}

void check_video_size(const std::string& what, int width, int height) {
  if (width <= 0 || height <= 0 || width % 2 || height % 2)
    throw UsageError(what + ": a video needs an even width and height, not " + std::to_string(width) + " x " +
                     std::to_string(height));
}

VideoWriter::VideoWriter(const std::filesystem::path& path, int width, int height, double rate)
    : path_(path), frame_bytes_(std::size_t(width) * std::size_t(height) * 3) {
  check_video_size(path.string(), width, height);
  if (!(rate > 0)) throw UsageError(path.string() + ": a video needs a positive rate of frames");
  ffmpeg_ = std::make_unique<ProgramPipe>(find_program("ffmpeg", "ffmpeg"), ffmpeg_arguments(path, width, height, rate),
                                          ProgramPipe::Direction::to_program, path.string() + ": ffmpeg");
}

VideoWriter::~VideoWriter() = default;

void VideoWriter::write(std::span<const std::uint8_t> rgb) {
  if (rgb.size() != frame_bytes_) throw Failure(path_.string() + ": a frame of another size was given to the video");
  ffmpeg_->write(rgb.data(), rgb.size());
}

void VideoWriter::finish() { ffmpeg_->finish(); }

void join_videos(std::span<const std::filesystem::path> videos, const std::filesystem::path& to) {
  std::string list;
  for (const std::filesystem::path& video : videos) {
    std::string name = std::filesystem::absolute(video).string();
    // a quote ends the quoted name, stands alone behind a backslash, and opens it again
    for (std::size_t at = 0; (at = name.find('\'', at)) != std::string::npos; at += 4) name.replace(at, 1, "'\\''");
    list += "file 'file:" + name + "'\n";
  }
  ProgramPipe ffmpeg(find_program("ffmpeg", "ffmpeg"),
                     {"-hide_banner",
                      "-loglevel",
                      "error",
                      "-y",
                      "-f",
                      "concat",
                      "-safe",
                      "0",
                      "-protocol_whitelist",
                      "file,pipe",
                      "-i",
                      "pipe:0",
                      "-c",
                      "copy",
                      "-fflags",
                      "+bitexact",
                      "-map_metadata",
                      "-1",
                      "-movflags",
                      "+faststart",
                      "-f",
                      "mp4",
                      "file:" + to.string()},
                     ProgramPipe::Direction::to_program, videos.back().string() + ": ffmpeg");
  ffmpeg.write(list.data(), list.size());
  ffmpeg.finish();
}

}  // namespace pvg
