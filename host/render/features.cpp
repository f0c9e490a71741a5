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
    : program_(device, "render/features.cl", traversal_options(device)),
      note_(program_.kernel("note_features")),
      accumulate_(program_.kernel("accumulate_features")),
      feature_color_(device, 0, "feature_color"),
      feature_normal_(device, 0, "feature_normal") {}

void Features::note(std::size_t n, const Launch& launch, const DeviceScene& scene, const Buffer<std::uint32_t>& queue,
                    const Buffer<F32x4>& hit, const Buffer<std::uint32_t>& hit_instance, const Buffer<F32x4>& direction,
                    const Buffer<F32x4>& throughput) {
  feature_color_.resize(hit.size());
  feature_normal_.resize(hit.size());
  note_(n, std::uint32_t(n), launch, queue, scene.trees.instances, scene.materials, scene.textures, scene.texels,
        scene.decode, scene.triangles, scene.vertices, scene.colors, scene.second_uvs, scene.lights, scene.environment,
        scene.cells, hit, hit_instance, direction, throughput, feature_color_, feature_normal_);
}

void Features::accumulate(const Launch& launch, const Buffer<std::uint32_t>& pixels, Guides& guides) {
  accumulate_(launch.n_pixels, launch.n_pixels, launch, pixels, feature_color_, feature_normal_, guides.guide_color,
              guides.guide_normal);
}

}  // namespace pvg
