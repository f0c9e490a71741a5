#include "host/render/traversal.hpp"

namespace pvg {

std::string traversal_options(const Device& device) {
  const std::string options = avx_options(device.info());
  // Whole numbers travel in the fourth parts of vectors, where they are denormal floats. No result depends on their
  // products, but a processor takes its time for each; as zeros they cost nothing.
  return options.empty() ? options : options + " -cl-denorms-are-zero";
}

Traversal::Traversal(Device& device, bool one_by_one)
    : rays_per_item_(one_by_one ? 1 : RAYS_CHUNK),
      intersect_(one_by_one
                     ? Program(device, "render/wavefront/intersect.cl", traversal_options(device)).kernel("intersect")
                     : Program(device, "render/lanes/rays.cl", traversal_options(device)).kernel("intersect_lanes")),
      shadow_(one_by_one ? Program(device, "render/wavefront/shadow.cl", traversal_options(device)).kernel("shadow")
                         : Program(device, "render/lanes/rays.cl", traversal_options(device)).kernel("shadow_lanes")) {}

void Traversal::find_closest(std::size_t n, const Buffer<std::uint32_t>& queue, const DeviceTrees& trees,
                             const Buffer<F32x4>& origin, const Buffer<F32x4>& direction, Buffer<F32x4>& hit,
                             Buffer<std::uint32_t>& hit_instance) {
  intersect_(divided_up(n, rays_per_item_), std::uint32_t(n), queue, trees.top, trees.nodes, trees.blocks,
             trees.instances, origin, direction, hit, hit_instance);
}

void Traversal::add_light(std::size_t n, const Buffer<std::uint32_t>& queue, bool transparent_shadows,
                          const DeviceTrees& trees, const Buffer<Material>& materials,
                          const Buffer<F32x4>& shadow_origin, const Buffer<F32x4>& shadow_direction,
                          const Buffer<F32x4>& shadow_light, Buffer<F32x4>& radiance) {
  shadow_(divided_up(n, rays_per_item_), std::uint32_t(n), queue, std::uint32_t(transparent_shadows), trees.top,
          trees.nodes, trees.blocks, trees.instances, materials, shadow_origin, shadow_direction, shadow_light,
          radiance);
}

}  // namespace pvg
