#include "host/formats/video_reader.hpp"

#include <string>
#include <vector>

#include "host/base/error.hpp"
#include "host/base/program_pipe.hpp"
#include "host/formats/video.hpp"

namespace pvg {

std::size_t read_video(const std::filesystem::path& path, int width, int height, int side,
                       const std::function<void(std::span<const std::uint8_t>)>& take) {
  // the colours as VideoWriter wrote them
  std::string filter = "scale=flags=bicubic+accurate_rnd+full_chroma_int+bitexact:in_color_matrix=bt709:in_range=tv";
  if (side > 0) {
    const std::string text = std::to_string(side);
    filter = "crop='min(iw,ih)':'min(iw,ih)'," + filter + ":w=" + text + ":h=" + text;
    width = height = side;
  }
  ProgramPipe ffmpeg(find_program("ffmpeg", "ffmpeg"),
                     {"-hide_banner", "-loglevel", "error", "-nostdin", "-i", "file:" + path.string(), "-vf", filter,
                      "-fps_mode", "passthrough", "-f", "rawvideo", "-pix_fmt", "rgb24", "pipe:1"},
                     ProgramPipe::Direction::from_program, path.string());
  std::vector<std::uint8_t> rgb(std::size_t(width) * std::size_t(height) * 3);
  std::size_t n_pictures = 0, n = 0;
  while ((n = ffmpeg.read(rgb.data(), rgb.size())) == rgb.size()) {
    take(rgb);
    ++n_pictures;
  }
  ffmpeg.finish();
  if (n != 0)
    throw Failure(path.string() + ": its pictures are not " + std::to_string(width) + " x " + std::to_string(height));
  return n_pictures;
}

}  // namespace pvg
