#include "host/render/features.hpp"

#include "host/render/stages.hpp"

namespace pvg {

Guides::Guides(Device& device) : guide_color(device, 0, "guide_color"), guide_normal(device, 0, "guide_normal") {}

void Guides::begin(std::size_t n_pixels) {
  for (Buffer<F32x4>* buffer : {&guide_color, &guide_normal}) {
    buffer->resize(n_pixels);
    buffer->zero();
  }
}

Features::Features(Device& device)
    : accumulate_(Program(device, "render/features.cl", traversal_options(device)).kernel("accumulate_features")) {}

void Features::accumulate(const Launch& launch, const Buffer<std::uint32_t>& pixels, const Buffer<F32x4>& feature_color,
                          const Buffer<F32x4>& feature_normal, Guides& guides) {
  accumulate_(launch.n_pixels, launch.n_pixels, launch, pixels, feature_color, feature_normal, guides.guide_color,
              guides.guide_normal);
}

}  // namespace pvg
