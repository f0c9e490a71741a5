#include "host/render/denoiser.hpp"

#include <utility>

namespace pvg {
namespace {

constexpr int PASSES = 4;  // the last one reaches 16 pixels

}  // namespace

Denoiser::Denoiser(Device& device)
    : program_(device, "render/denoise.cl"),
      begin_(program_.kernel("denoise_begin")),
      variance_(program_.kernel("denoise_variance")),
      pass_(program_.kernel("denoise_pass")),
      end_(program_.kernel("denoise_end")),
      light_(device, 0, "light"),
      other_(device, 0, "other"),
      is_border_(device, 0, "is_border") {}

void Denoiser::operator()(std::uint32_t width, std::uint32_t height, Film& film) {
  const std::uint32_t n = width * height;
  light_.resize(n);
  other_.resize(n);
  is_border_.resize(n);
  begin_(n, n, film.sum, film.squares, film.guides->guide_color, light_);
  variance_(n, n, width, height, film.instance, light_, other_, is_border_);
  std::swap(light_, other_);
  for (int k = 0; k < PASSES; ++k) {
    pass_(n, n, width, height, std::int32_t(1 << k), film.instance, film.normal, film.place, is_border_, light_,
          other_);
    std::swap(light_, other_);
  }
  end_(n, n, light_, film.guides->guide_color, film.sum);
}

}  // namespace pvg
