// Bounding volume hierarchies with eight boxes per node, built on the host by several threads: a binary tree by the
// binned surface area heuristic (Wald 2007), then widened at the least cost (Ylitie, Karras, Laine 2017). The same tree
// for any number of threads.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "host/geometry/mesh.hpp"
#include "render/bvh.h"

namespace pvg {

struct Box {
  Vec3f lo = Vec3f::Constant(1e30f), hi = Vec3f::Constant(-1e30f);  // [m]; empty at first
  void add(const Vec3f& p) {
    lo = lo.cwiseMin(p);
    hi = hi.cwiseMax(p);
  }
  void add(const Box& b) {
    lo = lo.cwiseMin(b.lo);
    hi = hi.cwiseMax(b.hi);
  }
  Vec3f center() const { return 0.5f * (lo + hi); }
  // half the surface [m^2]
  float half_area() const {
    const Vec3f d = (hi - lo).cwiseMax(0.0f);
    return d.x() * d.y() + d.y() * d.z() + d.z() * d.x();
  }
};

struct Bvh {
  std::vector<BvhNode> nodes;              // root first, level by level; child < 0: ~child is an index into leaves
  std::vector<std::uint32_t> level_first;  // first node of each level, then the number of nodes
  struct Leaf {
    std::uint32_t first, count;  // of `order`
  };
  std::vector<Leaf> leaves;
  std::vector<std::uint32_t> order;  // the boxes' indices, leaf by leaf
  int stack_need = 0;                // entries that a traversal can put on its stack at most
};

enum class TreeQuality {
  fast,      // made anew while a mesh deforms
  thorough,  // several times slower; rays are faster
};

// Leaves hold at most max_leaf boxes. Nothing at all gives one node without children. Throws a Failure where the tree
// is deeper than the traversal's stack.
Bvh build_bvh(std::span<const Box> boxes, unsigned max_leaf, TreeQuality quality = TreeQuality::fast);

// Triangles packed four to a leaf; ids count from first_triangle.
std::vector<TriangleBlock> pack_blocks(const Bvh& bvh, std::span<const Vec3f> points,
                                       std::span<const Triangle> triangles, std::uint32_t first_triangle);
std::vector<Box> triangle_boxes(std::span<const Vec3f> points, std::span<const Triangle> triangles);

}  // namespace pvg
