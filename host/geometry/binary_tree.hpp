// The binary tree that a bounding volume hierarchy is widened from: binned surface area heuristic (Wald 2007), every
// place where few boxes are left; the same tree for any number of threads.
#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "host/geometry/bvh.hpp"

namespace pvg {

using Vec4f = Eigen::Array4f;

// a box in two registers; the last numbers mean nothing
struct Box4 {
  Vec4f lo = Vec4f::Constant(1e30f), hi = Vec4f::Constant(-1e30f);
  void add(const Vec4f& a, const Vec4f& b) {
    lo = lo.min(a);
    hi = hi.max(b);
  }
  void add(const Box4& b) { add(b.lo, b.hi); }
  float half_area() const {
    const Vec4f d = (hi - lo).max(0.0f);
    return d.x() * d.y() + d.y() * d.z() + d.z() * d.x();
  }
};

struct BinaryNode {
  Box4 box;
  int left = -1, right = -1;  // greater than the node's own index; -1: a leaf
  std::uint32_t first = 0, count = 0;
};

struct BinaryTree {
  std::vector<BinaryNode> nodes;  // root first
  // part k of the nodes is [parts[k], parts[k + 1]); children of a node of part k > 0 are in it, those of part 0
  // anywhere
  std::vector<int> parts;
  std::vector<std::uint32_t> order;  // the boxes' indices; a node's are [first, first + count)
};

// max_leaf: how many boxes a leaf of the wide tree may hold
BinaryTree build_binary_tree(std::span<const Box> boxes, unsigned max_leaf);

}  // namespace pvg
