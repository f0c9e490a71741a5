#include "host/render/geometry.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "host/base/counted.hpp"
#include "host/base/error.hpp"

namespace pvg {
namespace {

constexpr unsigned TRIANGLES_PER_BLOCK = 4;

void check(const VisualMesh& mesh, const std::string& name) {
  const std::string where = "visual mesh " + name + ": ";
  if (mesh.points.empty() || mesh.triangles.empty())
    throw UsageError(where + "it has no triangles; give it some or leave it out");
  if (!mesh.normals.empty() && mesh.normals.size() != mesh.points.size())
    throw UsageError(where + counted(mesh.normals.size(), "normal") + " for " + counted(mesh.points.size(), "point") +
                     "; one each, or none");
  if (!mesh.uvs.empty() && mesh.uvs.size() != mesh.points.size())
    throw UsageError(where + counted(mesh.uvs.size(), "texture coordinate") + " for " +
                     counted(mesh.points.size(), "point") + "; one each, or none");
  if (!mesh.colors.empty() && mesh.colors.size() != mesh.points.size())
    throw UsageError(where + counted(mesh.colors.size(), "colour") + " for " + counted(mesh.points.size(), "point") +
                     "; one each, or none");
  if (!mesh.second_uvs.empty() && mesh.second_uvs.size() != mesh.points.size())
    throw UsageError(where + counted(mesh.second_uvs.size(), "second texture coordinate") + " for " +
                     counted(mesh.points.size(), "point") + "; one each, or none");
  for (const Vec3f& color : mesh.colors)
    if (!color.allFinite() || color.minCoeff() < 0)
      throw UsageError(where + "a vertex colour is negative or not finite; repair the file");
  for (std::size_t i = 0; i < mesh.points.size(); ++i)
    if (!mesh.points[i].allFinite() || (!mesh.normals.empty() && !mesh.normals[i].allFinite()) ||
        (!mesh.uvs.empty() && !mesh.uvs[i].allFinite()) ||
        (!mesh.second_uvs.empty() && !mesh.second_uvs[i].allFinite()))
      throw UsageError(where + "vertex " + std::to_string(i) + " is not finite; repair the file");
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
    for (const std::uint32_t corner : mesh.triangles[i])
      if (corner >= mesh.points.size())
        throw UsageError(where + "triangle " + std::to_string(i) + " names vertex " + std::to_string(corner) + " of " +
                         std::to_string(mesh.points.size()));
}

Vertex make_vertex(const VisualMesh& mesh, std::size_t i) {
  Vertex v{};
  for (int c = 0; c < 3; ++c) {
    v.point[c] = mesh.points[i][c];
    if (!mesh.normals.empty()) v.normal[c] = mesh.normals[i][c];
  }
  if (!mesh.uvs.empty()) {
    v.uv[0] = mesh.uvs[i].x();
    v.uv[1] = mesh.uvs[i].y();
  }
  return v;
}

}  // namespace

PackedTree pack_tree(const MeshRange& range, std::span<const Vec3f> points, std::span<const Triangle> triangles,
                     TreeQuality quality) {
  Bvh bvh = build_bvh(triangle_boxes(points, triangles), TRIANGLES_PER_BLOCK, quality);
  PackedTree tree;
  tree.blocks = pack_blocks(bvh, points, triangles, range.first_triangle);
  tree.level_first = std::move(bvh.level_first);
  tree.nodes = std::move(bvh.nodes);
  for (BvhNode& node : tree.nodes)
    for (int& child : node.child)
      if (child != BVH_EMPTY) child = child >= 0 ? child + int(range.first_node) : ~(~child + int(range.first_block));
  return tree;
}

MeshRange GeometryArrays::add(const VisualMesh& mesh, const std::string& name, bool deforms) {
  check(mesh, name);
  MeshRange range;
  range.first_vertex = std::uint32_t(vertices.size());
  range.n_vertices = std::uint32_t(mesh.points.size());
  range.first_triangle = std::uint32_t(triangles.size() / 3);
  range.n_triangles = std::uint32_t(mesh.triangles.size());
  range.first_block = std::uint32_t(blocks.size());
  range.first_node = std::uint32_t(nodes.size());
  range.has_normals = !mesh.normals.empty();
  for (std::size_t i = 0; i < mesh.points.size(); ++i) {
    vertices.push_back(make_vertex(mesh, i));
    range.box.add(mesh.points[i]);
  }
  const Vec3f center = 0.5f * (range.box.lo + range.box.hi);
  for (const Vec3f& point : mesh.points) range.radius = std::max(range.radius, (point - center).norm());
  range.has_colors = !mesh.colors.empty();
  range.first_color = std::int32_t(colors.size() / 3) - std::int32_t(range.first_vertex);
  range.has_second_uvs = !mesh.second_uvs.empty();
  range.first_second_uv = std::int32_t(second_uvs.size() / 2) - std::int32_t(range.first_vertex);
  for (const Vec2f& uv : mesh.second_uvs) second_uvs.insert(second_uvs.end(), uv.data(), uv.data() + 2);
  for (const Vec3f& color : mesh.colors) colors.insert(colors.end(), color.data(), color.data() + 3);
  for (const Triangle& triangle : mesh.triangles)
    for (const std::uint32_t corner : triangle) triangles.push_back(range.first_vertex + corner);

  const PackedTree tree =
      pack_tree(range, mesh.points, mesh.triangles, deforms ? TreeQuality::fast : TreeQuality::thorough);
  range.level_first = tree.level_first;
  range.n_blocks = std::uint32_t(tree.blocks.size());
  nodes.insert(nodes.end(), tree.nodes.begin(), tree.nodes.end());
  blocks.insert(blocks.end(), tree.blocks.begin(), tree.blocks.end());
  if (deforms) {
    nodes.resize(nodes.size() + tree.nodes.size() / 4 + 8);
    blocks.resize(blocks.size() + tree.blocks.size() / 4 + 8);
  }
  range.node_room = std::uint32_t(nodes.size()) - range.first_node;
  range.block_room = std::uint32_t(blocks.size()) - range.first_block;
  return range;
}

Instance make_instance(const Eigen::Matrix<double, 3, 4>& to_world, const MeshRange& mesh, const std::string& name) {
  const Eigen::Matrix3d A = to_world.leftCols<3>();
  if (!to_world.allFinite() || !(std::abs(A.determinant()) > 1e-18))
    throw UsageError("visual " + name + ": its pose is singular or not finite");
  Eigen::Matrix<double, 3, 4> to_object;
  to_object.leftCols<3>() = A.inverse();
  to_object.col(3) = -to_object.leftCols<3>() * to_world.col(3);
  Instance instance{};
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 4; ++column) {
      instance.to_object[4 * row + column] = float(to_object(row, column));
      instance.to_world[4 * row + column] = float(to_world(row, column));
    }
  instance.root = mesh.first_node;
  instance.light = -1;
  instance.flags = (mesh.has_normals ? INSTANCE_NORMALS : 0u) | (mesh.has_colors ? INSTANCE_COLORS : 0u) |
                   (mesh.has_second_uvs ? INSTANCE_SECOND_UVS : 0u);
  if (to_world == Eigen::Matrix<double, 3, 4>::Identity()) instance.flags |= INSTANCE_UNMOVED;
  instance.first_color = mesh.first_color;
  instance.first_second_uv = mesh.first_second_uv;
  return instance;
}

Box world_box(const Instance& instance, const Box& box) {
  Box world;
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3f p(corner & 1 ? box.hi.x() : box.lo.x(), corner & 2 ? box.hi.y() : box.lo.y(),
                  corner & 4 ? box.hi.z() : box.lo.z());
    Vec3f q;
    for (int row = 0; row < 3; ++row) {
      const float* m = instance.to_world + 4 * row;
      q[row] = m[0] * p.x() + m[1] * p.y() + m[2] * p.z() + m[3];
    }
    world.add(q);
  }
  // the maps are rounded: a box of a micrometre more loses nothing
  const Vec3f margin = 1e-6f * (Vec3f::Ones() + world.lo.cwiseAbs().cwiseMax(world.hi.cwiseAbs()));
  world.lo -= margin;
  world.hi += margin;
  return world;
}

std::vector<BvhNode> build_instance_tree(const std::vector<Box>& boxes) {
  Bvh bvh = build_bvh(boxes, 1);
  for (BvhNode& node : bvh.nodes)
    for (int& child : node.child)
      if (child < 0) child = ~int(bvh.order[bvh.leaves[~child].first]);
  return bvh.nodes;
}

}  // namespace pvg
