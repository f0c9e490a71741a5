#include "host/render/refit.hpp"

namespace pvg {

Refit::Refit(Device& device)
    : program_(device, "render/refit.cl"),
      refit_blocks_(program_.kernel("refit_blocks")),
      refit_nodes_(program_.kernel("refit_nodes")) {}

void Refit::operator()(const MeshRange& mesh, const Buffer<std::uint32_t>& triangles, const Buffer<Vertex>& vertices,
                       Buffer<TriangleBlock>& blocks, Buffer<BvhNode>& nodes) {
  refit_blocks_(mesh.n_blocks, mesh.n_blocks, mesh.first_block, triangles, vertices, blocks);
  for (std::size_t level = mesh.level_first.size() - 1; level-- > 0;) {
    const std::uint32_t first = mesh.level_first[level], n = mesh.level_first[level + 1] - first;
    refit_nodes_(n, n, mesh.first_node + first, blocks, nodes);
  }
}

}  // namespace pvg
