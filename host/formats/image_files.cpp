#include "host/formats/image_files.hpp"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <cmath>

#include "host/base/error.hpp"

namespace pvg {

void write_image(const std::filesystem::path& path, const Image8& image) {
  const auto file = OIIO::ImageOutput::create(path.string());
  if (!file) throw Failure(path.string() + ": pictures of this format cannot be written");
  OIIO::ImageSpec spec(image.width, image.height, 3, OIIO::TypeDesc::UINT8);
  spec.attribute("oiio:ColorSpace", "sRGB");
  if (!file->open(path.string(), spec) || !file->write_image(OIIO::TypeDesc::UINT8, image.rgb.data()) || !file->close())
    throw Failure(path.string() + ": the picture could not be written: " + file->geterror());
}

void write_linear_image(const std::filesystem::path& path, std::span<const float> linear_rgb, int width, int height) {
  const auto file = OIIO::ImageOutput::create(path.string());
  if (!file) throw Failure(path.string() + ": pictures of this format cannot be written");
  OIIO::ImageSpec spec(width, height, 3, OIIO::TypeDesc::FLOAT);
  spec.attribute("oiio:ColorSpace", "Linear");
  if (!file->open(path.string(), spec) || !file->write_image(OIIO::TypeDesc::FLOAT, linear_rgb.data()) ||
      !file->close())
    throw Failure(path.string() + ": the picture could not be written: " + file->geterror());
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

Image8 read_image(const std::filesystem::path& path) {
  const auto file = OIIO::ImageInput::open(path.string());
  if (!file) throw Failure(path.string() + ": the picture could not be read: " + OIIO::geterror());
  const OIIO::ImageSpec& spec = file->spec();
  if (spec.nchannels < 3) throw Failure(path.string() + ": the picture has no three colours");
  Image8 image{spec.width, spec.height,
               std::vector<std::uint8_t>(std::size_t(spec.width) * std::size_t(spec.height) * 3)};
  if (!file->read_image(0, 0, 0, 3, OIIO::TypeDesc::UINT8, image.rgb.data()))
    throw Failure(path.string() + ": the picture could not be read: " + file->geterror());
  return image;
}

}  // namespace pvg
