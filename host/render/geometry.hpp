// All meshes of a scene in shared arrays: vertices, triangles, and one tree per mesh.
#pragma once
#include <span>
#include <string>
#include <vector>

#include "host/geometry/bvh.hpp"
#include "host/model/scene.hpp"
#include "render/path.h"

namespace pvg {

// where one mesh lies in the arrays
struct MeshRange {
  std::uint32_t first_vertex = 0, n_vertices = 0;
  std::uint32_t first_triangle = 0, n_triangles = 0;
  std::uint32_t first_block = 0, n_blocks = 0, block_room = 0;  // room: places kept for it, at least those in use
  std::uint32_t first_node = 0, node_room = 0;                  // first: the root
  std::vector<std::uint32_t> level_first;  // nodes of each level, from first_node on, then the number of nodes
  bool has_normals = false;
  bool has_colors = false;
  bool has_second_uvs = false;
  std::int32_t first_color = 0;      // colour of vertex i: first_color + i
  std::int32_t first_second_uv = 0;  // likewise
  Box box;                           // in the mesh's frame
  float radius = 0;                  // of the sphere around the box's centre that holds all points [m]
};

struct GeometryArrays {
  std::vector<Vertex> vertices;
  std::vector<float> colors;             // [n x 3] of meshes that have them
  std::vector<float> second_uvs;         // [n x 2] likewise
  std::vector<std::uint32_t> triangles;  // [n x 3] vertices
  std::vector<BvhNode> nodes;
  std::vector<TriangleBlock> blocks;

  // `name` is for messages. Refuses indices out of range, wrong lengths and numbers that are not finite. A mesh that
  // deforms gets room for the trees that it may need later.
  MeshRange add(const VisualMesh& mesh, const std::string& name, bool deforms = false);
};

// A tree as it lies in the shared arrays.
struct PackedTree {
  std::vector<BvhNode> nodes;         // from MeshRange::first_node on
  std::vector<TriangleBlock> blocks;  // from MeshRange::first_block on
  std::vector<std::uint32_t> level_first;
};
// Triangles name points of the mesh; in the tree they count from range.first_triangle.
PackedTree pack_tree(const MeshRange& range, std::span<const Vec3f> points, std::span<const Triangle> triangles,
                     TreeQuality quality);

// rows of [A | p]: maps of one instance. `to_world` in double; throws a UsageError naming `name` where it is singular.
Instance make_instance(const Eigen::Matrix<double, 3, 4>& to_world, const MeshRange& mesh, const std::string& name);

// the mesh's box in the world
Box world_box(const Instance& instance, const Box& box);

// The tree over instances; its leaves are instances.
std::vector<BvhNode> build_instance_tree(const std::vector<Box>& boxes);

}  // namespace pvg
