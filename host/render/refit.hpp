// The tree of one mesh that deforms, on the device: fitted to the moved vertices, leaves first, then the levels from
// the deepest up; and built anew on the host when the fitted one has become bad.
#pragma once
#include "host/device/device.hpp"
#include "host/render/geometry.hpp"

namespace pvg {

class Refit {
 public:
  explicit Refit(Device& device);
  void operator()(const MeshRange& mesh, const Buffer<std::uint32_t>& triangles, const Buffer<Vertex>& vertices,
                  Buffer<TriangleBlock>& blocks, Buffer<BvhNode>& nodes);
  // What a ray through the mesh's box costs by the surface area heuristic, up to a factor that does not change.
  float cost(const MeshRange& mesh, const Buffer<BvhNode>& nodes);

 private:
  Program program_;
  Kernel refit_blocks_, refit_nodes_, node_costs_;
  Buffer<float> costs_;
};

// of the whole mesh, by the tree's root
Box root_box(const MeshRange& mesh, const Buffer<BvhNode>& nodes);

// A new tree for where the vertices are now; triangles name points of the mesh. false: it finds no room, the old one
// stays.
bool rebuild(MeshRange& mesh, std::span<const Triangle> triangles, const Buffer<Vertex>& vertices,
             Buffer<TriangleBlock>& blocks, Buffer<BvhNode>& nodes);

}  // namespace pvg
