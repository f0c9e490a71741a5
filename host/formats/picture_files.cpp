#include "host/formats/picture_files.hpp"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <memory>
#include <string>

#include "host/base/error.hpp"
#include "host/base/outputs.hpp"
#include "host/base/quiet_libraries.hpp"

namespace pvg {
namespace {

// of rendered pictures: half of zlib's time at its own level 6, for 6 % larger files
constexpr int PNG_LEVEL = 4;

// The library does not look whether a full disk took the last bytes: the end of the format must be there.
void demand_end(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary | std::ios::ate);
  const std::streamoff size = in ? std::streamoff(in.tellg()) : 0;
  std::string last(std::size_t(std::min<std::streamoff>(size, 8)), '\0');
  in.seekg(size - std::streamoff(last.size()));
  in.read(last.data(), std::streamsize(last.size()));
  const std::string ending = path.extension().string();
  const bool is_whole = ending == ".png"   ? last.starts_with("IEND")
                        : ending == ".jpg" ? last.ends_with("\xff\xd9")
                                           : size > 0 && OIIO::ImageInput::open(path.string()) != nullptr;
  if (!is_whole) throw Failure(path.string() + ": the picture could not be written whole; is the disk full?");
}

}  // namespace

void write_picture(const std::filesystem::path& path, const Picture8& picture) {
  const auto file = OIIO::ImageOutput::create(path.string());
  if (!file) throw Failure(path.string() + ": pictures of this format cannot be written");
  OIIO::ImageSpec spec(picture.width, picture.height, 3, OIIO::TypeDesc::UINT8);
  spec.attribute("oiio:ColorSpace", "sRGB");
  if (path.extension() == ".png") spec.attribute("png:compressionLevel", PNG_LEVEL);
  if (!file->open(path.string(), spec) || !file->write_image(OIIO::TypeDesc::UINT8, picture.rgb.data()) ||
      !file->close())
    throw Failure(path.string() + ": the picture could not be written; is there room on the disk?");
  demand_end(path);
}

void write_linear_picture(const std::filesystem::path& path, std::span<const float> linear_rgb, int width, int height) {
  const auto file = OIIO::ImageOutput::create(path.string());
  if (!file) throw Failure(path.string() + ": pictures of this format cannot be written");
  OIIO::ImageSpec spec(width, height, 3, OIIO::TypeDesc::FLOAT);
  spec.attribute("oiio:ColorSpace", "Linear");
  if (!file->open(path.string(), spec) || !file->write_image(OIIO::TypeDesc::FLOAT, linear_rgb.data()) ||
      !file->close())
    throw Failure(path.string() + ": the picture could not be written; is there room on the disk?");
  demand_end(path);
}

std::vector<std::uint8_t> encode_png(const Texture& texture) {
  std::vector<unsigned char> bytes;
  OIIO::Filesystem::IOVecOutput memory(bytes);
  const auto file = OIIO::ImageOutput::create("texture.png");
  OIIO::ImageSpec spec(texture.width, texture.height, 4, OIIO::TypeDesc::UINT8);
  spec.attribute("oiio:UnassociatedAlpha", 1);
  if (!file || !file->set_ioproxy(&memory) || !file->open("texture.png", spec) ||
      !file->write_image(OIIO::TypeDesc::UINT8, texture.rgba.data()) || !file->close())
    throw Failure("a texture could not be packed as PNG");
  return bytes;
}

namespace {

std::unique_ptr<OIIO::ImageInput> open_picture(const std::filesystem::path& path) {
  remember_read(path);
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(path, ignored))
    throw UsageError(path.string() + " is no file; a picture is wanted");
  auto file = OIIO::ImageInput::open(path.string());
  if (!file)
    throw UsageError(path.string() + " could not be read: it is no picture, or a damaged one; export it again");
  return file;
}

}  // namespace

Picture8 read_picture(const std::filesystem::path& path) {
  const QuietLibraries quiet;
  const auto file = open_picture(path);
  const OIIO::ImageSpec& spec = file->spec();
  if (spec.nchannels < 3) throw UsageError(path.string() + ": the picture has no three colours; export it as RGB");
  Picture8 picture{spec.width, spec.height,
                   std::vector<std::uint8_t>(std::size_t(spec.width) * std::size_t(spec.height) * 3)};
  if (!file->read_image(0, 0, 0, 3, OIIO::TypeDesc::UINT8, picture.rgb.data()))
    throw UsageError(path.string() + " could not be read to its end: the picture is damaged; export it again");
  return picture;
}

Mask8 read_mask_picture(const std::filesystem::path& path) {
  const QuietLibraries quiet;
  const auto file = open_picture(path);
  Mask8 mask{file->spec().width, file->spec().height, {}};
  mask.pixels.resize(std::size_t(mask.width) * std::size_t(mask.height));
  if (!file->read_image(0, 0, 0, 1, OIIO::TypeDesc::UINT8, mask.pixels.data()))
    throw UsageError(path.string() + " could not be read to its end: the picture is damaged; export it again");
  const std::uint8_t largest = mask.pixels.empty() ? 0 : *std::max_element(mask.pixels.begin(), mask.pixels.end());
  if (largest > 0 && largest < 128)
    throw UsageError(path.string() + ": its largest value is " + std::to_string(largest) +
                     "; write 255 where the part is and 0 elsewhere");
  for (std::uint8_t& pixel : mask.pixels) pixel = pixel >= 128;
  return mask;
}

}  // namespace pvg
