#include "host/formats/depth_files.hpp"

#include <OpenImageIO/imageio.h>

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <string>

#include "host/base/error.hpp"
#include "host/base/files.hpp"
#include "host/base/outputs.hpp"
#include "host/base/quiet_libraries.hpp"

namespace pvg {
namespace {

namespace fs = std::filesystem;

constexpr int LARGEST_DEPTH_SIDE = 16384;  // [pixels]
constexpr double NONE = 65535;             // of 16-bit files, beside 0

DepthPicture read_colmap_depth(const fs::path& file, double unit) {
  const auto content = read_whole_file(file);
  if (!content) throw UsageError(file.string() + " cannot be read; a depth map is wanted");
  int width = 0, height = 0, channels = 0, length = 0;
  if (std::sscanf(content->substr(0, 64).c_str(), "%d&%d&%d&%n", &width, &height, &channels, &length) != 3 ||
      length == 0 || channels != 1 || width < 1 || height < 1 || width > LARGEST_DEPTH_SIDE ||
      height > LARGEST_DEPTH_SIDE)
    throw UsageError(file.string() + " is no depth map of COLMAP: it must begin with `width&height&1&`");
  const std::size_t n = std::size_t(width) * std::size_t(height);
  if (content->size() != std::size_t(length) + n * sizeof(float))
    throw UsageError(file.string() + ": its length does not fit its size; write it again");
  DepthPicture picture{width, height, std::vector<float>(n)};
  std::memcpy(picture.depth.data(), content->data() + length, n * sizeof(float));
  for (float& z : picture.depth) z = std::isfinite(z) && z > 0 ? z * float(unit) : 0;
  return picture;
}

}  // namespace

DepthPicture read_depth_picture(const fs::path& file, double unit) {
  remember_read(file);
  if (!is_file(file)) throw UsageError(file.string() + " is no file; a picture of depth is wanted");
  if (file.extension() == ".bin") return read_colmap_depth(file, unit);
  const QuietLibraries quiet;
  const auto in = OIIO::ImageInput::open(file.string());
  if (!in) throw UsageError(file.string() + " could not be read: it is no picture, or a damaged one; export it again");
  const OIIO::ImageSpec& spec = in->spec();
  const bool is_float = spec.format == OIIO::TypeDesc::FLOAT || spec.format == OIIO::TypeDesc::HALF;
  if (spec.nchannels != 1 || !(is_float || spec.format == OIIO::TypeDesc::UINT16))
    throw UsageError(file.string() + ": a picture of depth has one channel of 16 bits, or of floats; export it so");
  DepthPicture picture{spec.width, spec.height, std::vector<float>(std::size_t(spec.width) * std::size_t(spec.height))};
  if (!in->read_image(0, 0, 0, 1, OIIO::TypeDesc::FLOAT, picture.depth.data()))
    throw UsageError(file.string() + " could not be read to its end: the picture is damaged; export it again");
  for (float& z : picture.depth) {
    const double value = is_float ? z : std::round(double(z) * 65535);
    z = std::isfinite(value) && value > 0 && (is_float || value < NONE) ? float(value * unit) : 0;
  }
  return picture;
}

void write_depth_picture(const fs::path& file, const DepthPicture& picture, double unit) {
  std::vector<std::uint16_t> values(picture.depth.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double value = std::round(double(picture.depth[i]) / unit);
    values[i] = value > 0 && value < NONE ? std::uint16_t(value) : std::uint16_t(0);
  }
  const auto out = OIIO::ImageOutput::create(file.string());
  const OIIO::ImageSpec spec(picture.width, picture.height, 1, OIIO::TypeDesc::UINT16);
  if (!out || !out->open(file.string(), spec) || !out->write_image(OIIO::TypeDesc::UINT16, values.data()) ||
      !out->close())
    throw Failure(file.string() + ": the picture of depth could not be written; is there room on the disk?");
}

PictureSize picture_size(const fs::path& file) {
  remember_read(file);
  const QuietLibraries quiet;
  const auto in = OIIO::ImageInput::open(file.string());
  if (!in) throw UsageError(file.string() + " is missing, no picture, or a damaged one");
  return {in->spec().width, in->spec().height};
}

}  // namespace pvg
