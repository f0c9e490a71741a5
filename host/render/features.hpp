// What guides a denoiser, noted where paths are shaded (kernels/render/noted.cl). Only renderers that denoise have it.
#pragma once
#include "host/render/traversal.hpp"

namespace pvg {

// Sums over the samples of each pixel, last: samples in it  [height x width].
struct Guides {
  explicit Guides(Device& device);
  void begin(std::size_t n_pixels);  // empties them
  Buffer<F32x4> guide_color, guide_normal;
};

class Features {
 public:
  explicit Features(Device& device);
  // the launch's samples to those of its pixels; feature_...: by slot, as `shade` notes them
  void accumulate(const Launch& launch, const Buffer<std::uint32_t>& pixels, const Buffer<F32x4>& feature_color,
                  const Buffer<F32x4>& feature_normal, Guides& guides);

 private:
  Kernel accumulate_;
};

}  // namespace pvg
