#include "host/render/traversal.hpp"

namespace pvg {

std::string traversal_options(const Device& device) {
  const std::string options = avx_options(device.info());
  // Whole numbers travel in the fourth parts of vectors, where they are denormal floats. No result depends on their
  // products, but a processor takes its time for each; as zeros they cost nothing.
  return options.empty() ? options : options + " -cl-denorms-are-zero";
}

Traversal::Traversal(Device& device)
    : intersect_(Program(device, "render/intersect.cl", traversal_options(device)).kernel("intersect")),
      shadow_(Program(device, "render/shadow.cl", traversal_options(device)).kernel("shadow")) {
  if (device.info().is_gpu) return;
  const auto kernel = [&](const std::string& name) {
    return Program(device, "render/" + name + ".cl", traversal_options(device)).kernel(name);
  };
  intersect_packets_.emplace(kernel("intersect_packets"));
  intersect_lanes_.emplace(kernel("intersect_lanes"));
  shadow_lanes_.emplace(kernel("shadow_lanes"));
}

void Traversal::find_closest(std::size_t n, const Buffer<std::uint32_t>& queue, const DeviceTrees& trees,
                             const Buffer<F32x4>& origin, const Buffer<F32x4>& direction, Buffer<F32x4>& hit,
                             Buffer<std::uint32_t>& hit_instance) {
  if (intersect_lanes_)
    return (*intersect_lanes_)(divided_up(n, PACKET), std::uint32_t(n), queue, trees.top, trees.nodes, trees.blocks,
                               trees.instances, origin, direction, hit, hit_instance);
  intersect_(n, std::uint32_t(n), queue, trees.top, trees.nodes, trees.blocks, trees.instances, origin, direction, hit,
             hit_instance);
}

void Traversal::find_closest_of_neighbours(std::size_t n, const Buffer<std::uint32_t>& queue, const DeviceTrees& trees,
                                           const Buffer<F32x4>& origin, const Buffer<F32x4>& direction,
                                           Buffer<F32x4>& hit, Buffer<std::uint32_t>& hit_instance) {
  if (!intersect_packets_) return find_closest(n, queue, trees, origin, direction, hit, hit_instance);
  (*intersect_packets_)(divided_up(n, PACKET), std::uint32_t(n), trees.top, trees.nodes, trees.blocks, trees.instances,
                        origin, direction, hit, hit_instance);
}

void Traversal::add_light(std::size_t n, const Buffer<std::uint32_t>& queue, bool transparent_shadows,
                          const DeviceTrees& trees, const Buffer<Material>& materials,
                          const Buffer<F32x4>& shadow_origin, const Buffer<F32x4>& shadow_direction,
                          const Buffer<F32x4>& shadow_light, Buffer<F32x4>& radiance) {
  if (shadow_lanes_)
    return (*shadow_lanes_)(divided_up(n, SHADOW_CHUNK), std::uint32_t(n), queue, std::uint32_t(transparent_shadows),
                            trees.top, trees.nodes, trees.blocks, trees.instances, materials, shadow_origin,
                            shadow_direction, shadow_light, radiance);
  shadow_(n, std::uint32_t(n), queue, std::uint32_t(transparent_shadows), trees.top, trees.nodes, trees.blocks,
          trees.instances, materials, shadow_origin, shadow_direction, shadow_light, radiance);
}

}  // namespace pvg
