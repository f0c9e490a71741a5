#include "host/render/image_denoise.hpp"

#include <dlfcn.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <utility>

#include "host/base/error.hpp"

namespace pvg {
namespace {

// The part of the library's C interface that is used (its header is in no Debian package). Numbers of its enumerations.
constexpr int DEVICE_DEFAULT = 0, DEVICE_CPU = 1, FORMAT_FLOAT3 = 3, ERROR_NONE = 0;
using Handle = void*;  // of a device, buffer or filter

struct Interface {
  Handle (*new_device)(int type) = nullptr;
  void (*commit_device)(Handle device) = nullptr;
  void (*release_device)(Handle device) = nullptr;
  int (*device_number)(Handle device, const char* name) = nullptr;
  void (*set_device_flag)(Handle device, const char* name, bool value) = nullptr;
  int (*device_error)(Handle device, const char** message) = nullptr;
  Handle (*new_buffer)(Handle device, std::size_t bytes) = nullptr;
  void (*release_buffer)(Handle buffer) = nullptr;
  void (*write_buffer)(Handle buffer, std::size_t at, std::size_t bytes, const void* from) = nullptr;
  void (*read_buffer)(Handle buffer, std::size_t at, std::size_t bytes, void* to) = nullptr;
  Handle (*new_filter)(Handle device, const char* type) = nullptr;
  void (*release_filter)(Handle filter) = nullptr;
  void (*set_filter_image)(Handle filter, const char* name, Handle buffer, int format, std::size_t width,
                           std::size_t height, std::size_t offset, std::size_t pixel_stride,
                           std::size_t row_stride) = nullptr;
  void (*set_filter_flag)(Handle filter, const char* name, bool value) = nullptr;
  void (*commit_filter)(Handle filter) = nullptr;
  void (*execute_filter)(Handle filter) = nullptr;
};

template <class Function>
bool take(void* library, const char* name, Function*& function) {
  function = reinterpret_cast<Function*>(dlsym(library, name));
  return function != nullptr;
}

bool take_all(void* library, Interface& f) {
  return take(library, "oidnNewDevice", f.new_device) && take(library, "oidnCommitDevice", f.commit_device) &&
         take(library, "oidnReleaseDevice", f.release_device) && take(library, "oidnGetDeviceInt", f.device_number) &&
         take(library, "oidnSetDeviceBool", f.set_device_flag) && take(library, "oidnGetDeviceError", f.device_error) &&
         take(library, "oidnNewBuffer", f.new_buffer) && take(library, "oidnReleaseBuffer", f.release_buffer) &&
         take(library, "oidnWriteBuffer", f.write_buffer) && take(library, "oidnReadBuffer", f.read_buffer) &&
         take(library, "oidnNewFilter", f.new_filter) && take(library, "oidnReleaseFilter", f.release_filter) &&
         take(library, "oidnSetFilterImage", f.set_filter_image) &&
         take(library, "oidnSetFilterBool", f.set_filter_flag) && take(library, "oidnCommitFilter", f.commit_filter) &&
         take(library, "oidnExecuteFilter", f.execute_filter);
}

// The library's network takes what is beyond a picture for black, which shows at corners: the last pixel of 640 x 360
// comes out twice as bright as it is (2.5.1 on a CPU), others by a fifth too bright or dark. So pictures get a margin
// that mirrors them, which is cut off again. Sides of whole units need no further one: the network halves them four
// times.
constexpr std::uint32_t SIDE_UNIT = 16, LEAST_MARGIN = 4;

std::uint32_t with_margins(std::uint32_t side) {
  return (side + 2 * LEAST_MARGIN + SIDE_UNIT - 1) / SIDE_UNIT * SIDE_UNIT;
}

// before the first pixel
std::uint32_t margin(std::uint32_t side) { return (with_margins(side) - side) / 2; }

// the pixel of a picture that one of the larger picture stands for
std::uint32_t mirrored(std::uint32_t at, std::uint32_t side) {
  const std::uint32_t period = std::max(1u, 2 * (side - 1));
  const std::uint32_t folded = (at + (period - 1) * margin(side)) % period;
  return folded < side ? folded : period - folded;
}

// [height x width x 3], with margins
std::vector<float> enlarged(const std::vector<float>& picture, std::uint32_t width, std::uint32_t height) {
  std::vector<float> larger;
  larger.reserve(std::size_t(3) * with_margins(width) * with_margins(height));
  for (std::uint32_t y = 0; y < with_margins(height); ++y)
    for (std::uint32_t x = 0; x < with_margins(width); ++x) {
      const std::size_t i = 3 * (std::size_t(mirrored(y, height)) * width + mirrored(x, width));
      larger.insert(larger.end(), {picture[i], picture[i + 1], picture[i + 2]});
    }
  return larger;
}

std::vector<float> without_margins(const std::vector<float>& larger, std::uint32_t width, std::uint32_t height) {
  std::vector<float> picture;
  picture.reserve(std::size_t(3) * width * height);
  for (std::uint32_t y = 0; y < height; ++y) {
    const std::uint32_t first = (y + margin(height)) * with_margins(width) + margin(width);
    const auto row = larger.begin() + std::ptrdiff_t(3) * std::ptrdiff_t(first);
    picture.insert(picture.end(), row, row + 3 * std::ptrdiff_t(width));
  }
  return picture;
}

constexpr const char* FILE_NAME = "libOpenImageDenoise.so.2";

void* open_library() {
  namespace fs = std::filesystem;
  std::vector<std::string> places;
  if (const char* asked = std::getenv("PVG_DENOISER"))
    places = {fs::is_directory(asked) ? (fs::path(asked) / FILE_NAME).string() : std::string(asked)};
  else
    places = {(fs::path(PVG_DENOISER_FOLDER) / FILE_NAME).string(), FILE_NAME};
  for (const std::string& place : places)
    if (void* library = dlopen(place.c_str(), RTLD_NOW | RTLD_LOCAL)) return library;
  return nullptr;
}

}  // namespace

// It stays loaded: its threads may outlive the last picture.
struct ImageDenoise::Library {
  Interface call;
  Handle device = nullptr, filter = nullptr;
  Handle buffers[4] = {};  // light, colour, normal, result
  std::uint32_t width = 0, height = 0;

  void release_pictures() {
    if (filter) call.release_filter(filter);
    filter = nullptr;
    for (Handle& buffer : buffers) {
      if (buffer) call.release_buffer(buffer);
      buffer = nullptr;
    }
  }

  ~Library() {
    release_pictures();
    if (device) call.release_device(device);
  }

  void check() {
    const char* message = nullptr;
    if (call.device_error(device, &message) == ERROR_NONE) return;
    throw Failure(std::string("Open Image Denoise: ") + (message ? message : "an error without a message"));
  }

  void begin(std::uint32_t new_width, std::uint32_t new_height) {
    if (filter && new_width == width && new_height == height) return;
    release_pictures();
    width = new_width;
    height = new_height;
    filter = call.new_filter(device, "RT");
    constexpr const char* NAMES[] = {"color", "albedo", "normal", "output"};
    for (int i = 0; i < 4; ++i) {
      buffers[i] = call.new_buffer(device, sizeof(float) * 3 * width * height);
      check();
      call.set_filter_image(filter, NAMES[i], buffers[i], FORMAT_FLOAT3, width, height, 0, 0, 0);
    }
    call.set_filter_flag(filter, "hdr", true);
    call.commit_filter(filter);
    check();
  }
};

std::optional<ImageDenoise> ImageDenoise::find(bool on_gpu) {
  void* opened = open_library();
  if (!opened) return std::nullopt;
  auto library = std::make_unique<Library>();
  if (!take_all(opened, library->call)) return std::nullopt;
  library->device = library->call.new_device(on_gpu ? DEVICE_DEFAULT : DEVICE_CPU);
  if (!library->device) return std::nullopt;
  // else it would bind the threads that we share processors with
  if (!on_gpu) library->call.set_device_flag(library->device, "setAffinity", false);
  library->call.commit_device(library->device);
  const char* message = nullptr;
  if (library->call.device_error(library->device, &message) != ERROR_NONE) return std::nullopt;
  return ImageDenoise(std::move(library));
}

ImageDenoise::ImageDenoise(std::unique_ptr<Library> library) : library_(std::move(library)) {}
ImageDenoise::ImageDenoise(ImageDenoise&&) noexcept = default;
ImageDenoise::~ImageDenoise() = default;

std::vector<float> ImageDenoise::filter(const NoisyPicture& picture) {
  Library& l = *library_;
  l.begin(with_margins(picture.width), with_margins(picture.height));
  const std::size_t bytes = sizeof(float) * 3 * l.width * l.height;
  const std::vector<float>* inputs[] = {&picture.rgb, &picture.color, &picture.normal};
  for (int i = 0; i < 3; ++i)
    l.call.write_buffer(l.buffers[i], 0, bytes, enlarged(*inputs[i], picture.width, picture.height).data());
  l.call.execute_filter(l.filter);
  l.check();
  std::vector<float> filtered(bytes / sizeof(float));
  l.call.read_buffer(l.buffers[3], 0, bytes, filtered.data());
  l.check();
  return without_margins(filtered, picture.width, picture.height);
}

std::string ImageDenoise::name() const {
  const Library& l = *library_;
  const auto number = [&](const char* name) { return std::to_string(l.call.device_number(l.device, name)); };
  return "Open Image Denoise " + number("versionMajor") + "." + number("versionMinor") + "." + number("versionPatch");
}

}  // namespace pvg
