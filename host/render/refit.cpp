#include "host/render/refit.hpp"

namespace pvg {

Refit::Refit(Device& device)
    : program_(device, "render/refit.cl"),
      refit_blocks_(program_.kernel("refit_blocks")),
      refit_nodes_(program_.kernel("refit_nodes")),
      node_costs_(program_.kernel("node_costs")),
      costs_(device, 0, "costs") {}

void Refit::operator()(const MeshRange& mesh, const Buffer<std::uint32_t>& triangles, const Buffer<Vertex>& vertices,
                       Buffer<TriangleBlock>& blocks, Buffer<BvhNode>& nodes) {
  refit_blocks_(mesh.n_blocks, mesh.n_blocks, mesh.first_block, triangles, vertices, blocks);
  for (std::size_t level = mesh.level_first.size() - 1; level-- > 0;) {
    const std::uint32_t first = mesh.level_first[level], n = mesh.level_first[level + 1] - first;
    refit_nodes_(n, n, mesh.first_node + first, blocks, nodes);
  }
}

float Refit::cost(const MeshRange& mesh, const Buffer<BvhNode>& nodes) {
  const std::uint32_t n = mesh.level_first.back();
  costs_.resize(n);
  node_costs_(n, n, mesh.first_node, nodes, costs_);
  double sum = 0;
  for (const float cost : costs_.read()) sum += cost;
  const float area = root_box(mesh, nodes).half_area();
  return area > 0 ? float(sum / area) : 0.0f;
}

Box root_box(const MeshRange& mesh, const Buffer<BvhNode>& nodes) {
  const BvhNode root = nodes.read(mesh.first_node, 1).front();
  Box box;
  for (int k = 0; k < BVH_WIDTH; ++k) {
    if (root.child[k] == BVH_EMPTY) continue;
    box.add(Box{{root.lo_x[k], root.lo_y[k], root.lo_z[k]}, {root.hi_x[k], root.hi_y[k], root.hi_z[k]}});
  }
  return box;
}

bool rebuild(MeshRange& mesh, std::span<const Triangle> triangles, const Buffer<Vertex>& vertices,
             Buffer<TriangleBlock>& blocks, Buffer<BvhNode>& nodes) {
  std::vector<Vec3f> points;
  points.reserve(mesh.n_vertices);
  for (const Vertex& vertex : vertices.read(mesh.first_vertex, mesh.n_vertices))
    points.push_back(Eigen::Map<const Vec3f>(vertex.point));
  const PackedTree tree = pack_tree(mesh, points, triangles, TreeQuality::fast);
  if (tree.nodes.size() > mesh.node_room || tree.blocks.size() > mesh.block_room) return false;
  nodes.write(mesh.first_node, tree.nodes);
  blocks.write(mesh.first_block, tree.blocks);
  mesh.level_first = tree.level_first;
  mesh.n_blocks = std::uint32_t(tree.blocks.size());
  return true;
}

}  // namespace pvg
