// Intel's Open Image Denoise, found when the program runs: nothing is linked, and without it there is our own filter
// (denoiser.hpp). scripts/install_denoiser.sh installs it.
#pragma once
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace pvg {

// What it filters, all [height x width x 3]. Linear light of a picture, and what guides it: colours in [0, 1] and
// normals, means over the samples of each pixel.
struct NoisyPicture {
  std::uint32_t width = 0, height = 0;
  std::vector<float> rgb, color, normal;
};

class ImageDenoise {
 public:
  // Nothing where the library is not there or does not run on this machine. It is looked for in $PVG_DENOISER, a file
  // or the folder that holds libOpenImageDenoise.so.2, else in what scripts/install_denoiser.sh made, else where the
  // system looks for libraries. $PVG_DENOISER=none stands for a machine without it. on_gpu: its own choice of the
  // fastest device, else the processor.
  static std::optional<ImageDenoise> find(bool on_gpu);
  ImageDenoise(ImageDenoise&&) noexcept;
  ~ImageDenoise();

  // The filtered light; the same bits for the same input on the same device. A Failure with its message else.
  std::vector<float> filter(const NoisyPicture& picture);
  std::string name() const;  // "Open Image Denoise 2.5.1"

  struct Library;

 private:
  explicit ImageDenoise(std::unique_ptr<Library> library);
  std::unique_ptr<Library> library_;
};

}  // namespace pvg
