#include "host/formats/textures.hpp"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include "host/base/error.hpp"
#include "host/base/outputs.hpp"
#include "host/base/quiet_libraries.hpp"
#include "host/pictures/srgb.hpp"

namespace pvg {

namespace {

constexpr int LARGEST_SIDE = 16384;  // [pixels]

// colours are not to be multiplied with alpha
OIIO::ImageSpec colors_as_stored() {
  OIIO::ImageSpec settings;
  settings.attribute("oiio:UnassociatedAlpha", 1);
  return settings;
}

void check_size(const OIIO::ImageSpec& spec, const std::string& name) {
  if (spec.width < 1 || spec.height < 1 || spec.nchannels < 1) throw UsageError(name + ": the picture is empty.");
  if (spec.width > LARGEST_SIDE || spec.height > LARGEST_SIDE)
    throw UsageError(name + ": the picture has " + std::to_string(spec.width) + " x " + std::to_string(spec.height) +
                     " pixels; scale it down to at most " + std::to_string(LARGEST_SIDE) + " on a side.");
}

std::unique_ptr<OIIO::ImageInput> open_texture(const std::filesystem::path& file) {
  if (!is_file(file)) throw UsageError(file.string() + ": there is no such texture file.");
  remember_read(file);
  const OIIO::ImageSpec as_stored = colors_as_stored();
  const QuietLibraries quiet;
  auto input = OIIO::ImageInput::open(file.string(), &as_stored);
  if (!input)
    throw UsageError(file.string() + ": cannot be read as a picture: it is none, or damaged; export it again.");
  const OIIO::ImageSpec& spec = input->spec();
  check_size(spec, file.string());
  return input;
}

}  // namespace

EnvironmentMap read_environment(const std::filesystem::path& file) {
  const auto input = open_texture(file);
  const OIIO::ImageSpec& spec = input->spec();
  if (spec.nchannels < 3) throw UsageError(file.string() + ": the picture has no three colours.");
  EnvironmentMap map;
  map.width = spec.width;
  map.height = spec.height;
  map.rgb.resize(std::size_t(map.width) * std::size_t(map.height) * 3);
  const bool is_coded = spec.format == OIIO::TypeDesc::UINT8;
  const QuietLibraries quiet;
  if (!input->read_image(0, 0, 0, 3, OIIO::TypeDesc::FLOAT, map.rgb.data()))
    throw UsageError(file.string() + ": the picture is damaged; export it again.");
  if (is_coded)
    for (float& value : map.rgb) value = srgb_to_linear(value);
  return map;
}

namespace {

Texture read_pixels(OIIO::ImageInput& input, const std::string& name) {
  const OIIO::ImageSpec& spec = input.spec();
  const int n = spec.nchannels;
  std::vector<std::uint8_t> pixels(std::size_t(spec.width) * spec.height * n);
  const QuietLibraries quiet;
  if (!input.read_image(0, 0, 0, n, OIIO::TypeDesc::UINT8, pixels.data())) {
    throw UsageError(name + ": the picture is damaged; export it again.");
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

}  // namespace

Texture read_texture(const std::filesystem::path& file) { return read_pixels(*open_texture(file), file.string()); }

Texture unpack_texture(const std::vector<unsigned char>& bytes, const std::string& name) {
  if (bytes.empty()) throw UsageError(name + ": the picture is missing or empty.");
  OIIO::Filesystem::IOMemReader memory(bytes.data(), bytes.size());
  // the format is known by its first bytes: PNG begins with 0x89
  const std::string as = bytes[0] == 0x89 ? "texture.png" : "texture.jpg";
  OIIO::ImageSpec as_stored = colors_as_stored();
  OIIO::Filesystem::IOProxy* from = &memory;
  as_stored.attribute("oiio:ioproxy", OIIO::TypeDesc::PTR, &from);
  std::unique_ptr<OIIO::ImageInput> input;
  {
    const QuietLibraries quiet;
    input = OIIO::ImageInput::open(as, &as_stored);
  }
  if (!input) throw UsageError(name + ": cannot be read as a PNG or JPEG picture; export it again.");
  check_size(input->spec(), name);
  return read_pixels(*input, name);
}

}  // namespace pvg
