#include "host/io/textures.hpp"

#include <OpenImageIO/imageio.h>

#include "host/base/error.hpp"

namespace pvg {

Texture read_texture(const std::filesystem::path& file) {
  if (!std::filesystem::is_regular_file(file)) throw UsageError(file.string() + ": there is no such texture file.");
  const auto input = OIIO::ImageInput::open(file.string());
  if (!input) throw UsageError(file.string() + ": cannot be read as a picture: " + OIIO::geterror() + ".");
  const OIIO::ImageSpec& spec = input->spec();
  const int n = spec.nchannels;
  if (spec.width < 1 || spec.height < 1 || n < 1) throw UsageError(file.string() + ": the picture is empty.");
  std::vector<std::uint8_t> pixels(std::size_t(spec.width) * spec.height * n);
  if (!input->read_image(0, 0, 0, n, OIIO::TypeDesc::UINT8, pixels.data())) {
    throw UsageError(file.string() + ": the picture is damaged: " + input->geterror() + ".");
  }
  Texture texture{spec.width, spec.height, {}};
  texture.rgba.resize(std::size_t(spec.width) * spec.height * 4, 255);
  const bool is_grey = n < 3;
  for (std::size_t i = 0; i < texture.rgba.size() / 4; ++i) {
    for (int c = 0; c < 3; ++c) texture.rgba[4 * i + c] = pixels[n * i + (is_grey ? 0 : c)];
    if (n == 2 || n >= 4) texture.rgba[4 * i + 3] = pixels[n * i + (n == 2 ? 1 : 3)];
  }
  return texture;
}

}  // namespace pvg
