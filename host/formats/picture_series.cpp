#include "host/formats/picture_series.hpp"

#include <algorithm>
#include <charconv>
#include <optional>
#include <sstream>
#include <string>
#include <tuple>

#include "host/base/counted.hpp"
#include "host/base/error.hpp"
#include "host/base/outputs.hpp"
#include "host/base/program_pipe.hpp"
#include "host/formats/picture_files.hpp"
#include "host/formats/video.hpp"
#include "host/formats/video_reader.hpp"
#include "host/hdf5/series.hpp"

namespace pvg {
namespace {

namespace fs = std::filesystem;

PictureSeries read_hdf5(const fs::path& path) {
  const std::string name = path.string();
  const hdf5::File file = hdf5::File::open(path);
  if (!file.has("/rgb")) throw UsageError(name + " has no array /rgb [frames, height, width, 3] of pictures");
  const hdf5::Shape shape = file.shape("/rgb");
  if (shape.size() != 4 || shape[1] == 0 || shape[2] == 0 || shape[3] != 3)
    throw UsageError(name + ": /rgb must have the shape [frames, height, width, 3]");
  PictureSeries series{int(shape[2]), int(shape[1]), {}, {}};
  for (std::uint64_t frame = 0; frame < shape[0]; ++frame)
    series.cells.push_back(cell_luminance(file.read_row<std::uint8_t>("/rgb", frame), series.width, series.height));
  if (!file.has("/time")) return series;
  series.time = file.read<double>("/time").values;
  if (series.time.size() != series.cells.size())
    throw UsageError(name + ": /time has " + counted(series.time.size(), "number") + " for " +
                     counted(series.cells.size(), "picture"));
  return series;
}

// %d or %06d in the name of a picture file
struct Numbered {
  std::string before, after;
  std::size_t digits = 0;
  fs::path at(std::size_t number) const {
    const std::string text = std::to_string(number);
    return before + std::string(digits > text.size() ? digits - text.size() : 0, '0') + text + after;
  }
};

std::optional<Numbered> numbered(const std::string& name) {
  const std::size_t percent = name.find('%'), d = name.find('d', percent);
  if (percent == std::string::npos || d == std::string::npos) return std::nullopt;
  Numbered result{name.substr(0, percent), name.substr(d + 1)};
  const std::string digits = name.substr(percent + 1, d - percent - 1);
  const auto parsed = std::from_chars(digits.data(), digits.data() + digits.size(), result.digits);
  if (!digits.empty() && (parsed.ec != std::errc() || parsed.ptr != digits.data() + digits.size() || digits[0] != '0'))
    return std::nullopt;
  return result;
}

PictureSeries read_numbered(const fs::path& path, const Numbered& files) {
  PictureSeries series;
  std::size_t number = fs::exists(files.at(0)) ? 0 : 1;
  for (; fs::exists(files.at(number)); ++number) {
    const Picture8 picture = read_picture(files.at(number));
    if (series.cells.empty()) series.width = picture.width, series.height = picture.height;
    if (picture.width != series.width || picture.height != series.height)
      throw UsageError(files.at(number).string() + " has another size than the pictures before it");
    series.cells.push_back(cell_luminance(picture.rgb, picture.width, picture.height));
  }
  if (series.cells.empty())
    throw UsageError(path.string() + ": there is no first picture; " + files.at(0).string() + " is not there");
  if (fs::exists(files.at(number + 1)))
    throw UsageError(files.at(number).string() + " is missing, though the picture after it is there");
  return series;
}

// width and height of a video's first picture, from the head of a PPM file: P6, width, height
std::pair<int, int> size_of_video(const fs::path& path) {
  ProgramPipe ffmpeg(find_program("ffmpeg", "ffmpeg"),
                     {"-hide_banner", "-loglevel", "error", "-nostdin", "-i", "file:" + path.string(), "-frames:v", "1",
                      "-f", "image2pipe", "-c:v", "ppm", "pipe:1"},
                     ProgramPipe::Direction::from_program, path.string());
  std::string head;
  std::vector<char> part(1 << 16);
  while (const std::size_t n = ffmpeg.read(part.data(), part.size()))
    if (head.size() < 64) head.append(part.data(), std::min<std::size_t>(n, 64));
  ffmpeg.finish();
  std::string magic;
  int width = 0, height = 0;
  std::istringstream(head) >> magic >> width >> height;
  if (magic != "P6" || width < 1 || height < 1) throw UsageError(path.string() + " holds no picture");
  return {width, height};
}

PictureSeries read_video_file(const fs::path& path) {
  if (!is_file(path)) throw UsageError(path.string() + " is not there");
  PictureSeries series;
  std::tie(series.width, series.height) = size_of_video(path);
  read_video(path, series.width, series.height, 0, [&](std::span<const std::uint8_t> rgb) {
    series.cells.push_back(cell_luminance(rgb, series.width, series.height));
  });
  return series;
}

}  // namespace

PictureSeries read_picture_series(const fs::path& path) {
  const std::string suffix = path.extension().string();
  try {
    if (suffix == ".h5" || suffix == ".hdf5") return read_hdf5(path);
    if (const std::optional<Numbered> files = numbered(path.string())) return read_numbered(path, *files);
    if (suffix == ".png" || suffix == ".jpg")
      throw UsageError(path.string() + " is one picture; name a series of them by its numbers, such as wrist_%06d" +
                       suffix);
    return read_video_file(path);
  } catch (const Failure& failure) {
    throw UsageError(failure.what());
  }
}

}  // namespace pvg
