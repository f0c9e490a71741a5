// Fits the tree of one mesh to its moved vertices, on the device: leaves first, then the levels from the deepest up.
#pragma once
#include "host/device/device.hpp"
#include "host/render/geometry.hpp"

namespace pvg {

class Refit {
 public:
  explicit Refit(Device& device);
  void operator()(const MeshRange& mesh, const Buffer<std::uint32_t>& triangles, const Buffer<Vertex>& vertices,
                  Buffer<TriangleBlock>& blocks, Buffer<BvhNode>& nodes);

 private:
  Program program_;
  Kernel refit_blocks_, refit_nodes_;
};

}  // namespace pvg
