// What guides a denoiser, noted beside the paths (kernels/render/features.cl). Only renderers that denoise have it.
#pragma once
#include "host/render/traversal.hpp"

namespace pvg {

struct DeviceScene;

// Sums over the samples of each pixel, last: samples in it  [height x width].
struct Guides {
  explicit Guides(Device& device);
  void begin(std::size_t n_pixels);  // empties them
  Buffer<F32x4> guide_color, guide_normal;
};

class Features {
 public:
  explicit Features(Device& device);
  // of the first n places in the queue; hit .. throughput: of the paths, by slot
  void note(std::size_t n, const Launch& launch, const DeviceScene& scene, const Buffer<std::uint32_t>& queue,
            const Buffer<F32x4>& hit, const Buffer<std::uint32_t>& hit_instance, const Buffer<F32x4>& direction,
            const Buffer<F32x4>& throughput);
  // the launch's samples to those of its pixels
  void accumulate(const Launch& launch, const Buffer<std::uint32_t>& pixels, Guides& guides);

 private:
  Program program_;
  Kernel note_, accumulate_;
  Buffer<F32x4> feature_color_, feature_normal_;  // by slot
};

}  // namespace pvg
