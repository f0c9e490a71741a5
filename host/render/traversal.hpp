// The questions that rays ask of the scene's trees, as launches: what do they meet first, and does light arrive.
#pragma once
#include <string>

#include "host/device/device.hpp"
#include "materials/material.h"
#include "render/bvh.h"
#include "render/path.h"

namespace pvg {

// The two-level hierarchy: a tree over instances, below it one tree per mesh.
struct DeviceTrees {
  Buffer<BvhNode> top, nodes;
  Buffer<TriangleBlock> blocks;
  Buffer<Instance> instances;
};

// -DPVG_X86_AVX where PoCL compiles for an x86 CPU that has it, else nothing
std::string traversal_options(const Device& device);

// how many parts of at most that size n things make
constexpr std::size_t divided_up(std::size_t n, std::size_t part) { return n / part + (n % part > 0); }

class Traversal {
 public:
  // one_by_one: a work-item takes one ray, as a GPU needs it; else RAYS_CHUNK of them, sixteen side by side, for a CPU
  Traversal(Device& device, bool one_by_one);
  // of the n slots in the queue; arguments as in wavefront/intersect.cl
  void find_closest(std::size_t n, const Buffer<std::uint32_t>& queue, const DeviceTrees& trees,
                    const Buffer<F32x4>& origin, const Buffer<F32x4>& direction, Buffer<F32x4>& hit,
                    Buffer<std::uint32_t>& hit_instance);
  // adds to the radiance what arrives of the light; arguments as in wavefront/shadow.cl
  void add_light(std::size_t n, const Buffer<std::uint32_t>& queue, bool transparent_shadows, const DeviceTrees& trees,
                 const Buffer<Material>& materials, const Buffer<F32x4>& shadow_origin,
                 const Buffer<F32x4>& shadow_direction, const Buffer<F32x4>& shadow_light, Buffer<F32x4>& radiance);

 private:
  std::size_t rays_per_item_;
  Kernel intersect_, shadow_;
};

}  // namespace pvg
