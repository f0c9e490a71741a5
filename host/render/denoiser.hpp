// The edge-avoiding filter of kernels/render/denoise.cl, on the device: for previews, not for ground truth.
#pragma once
#include "host/render/stages.hpp"

namespace pvg {

class Denoiser {
 public:
  explicit Denoiser(Device& device);
  // replaces the film's sums; its ground truth and its guides must be there
  void operator()(std::uint32_t width, std::uint32_t height, Film& film);

 private:
  Program program_;
  Kernel begin_, variance_, pass_, end_;
  Buffer<F32x4> light_, other_;
  Buffer<std::uint32_t> is_border_;
};

}  // namespace pvg
