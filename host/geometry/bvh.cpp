#include "host/geometry/bvh.hpp"

#include <algorithm>
#include <array>
#include <numeric>
#include <string>

#include "host/base/error.hpp"

namespace pvg {
namespace {

constexpr int N_BINS = 16;
constexpr int MEDIAN_DEPTH = 40;  // deeper than this the halves are made equal, so that the depth stays bounded

struct BinaryNode {
  Box box;
  int left = -1, right = -1;  // -1: a leaf
  std::uint32_t first = 0, count = 0;
};

struct Split {
  int axis = -1;  // -1: none is better than equal halves
  int bin = 0;
  float cost = 1e30f;
};

struct Builder {
  std::span<const Box> boxes;
  unsigned max_leaf;
  std::vector<std::uint32_t> order;
  std::vector<BinaryNode> nodes;

  int bin_of(std::uint32_t box, int axis, const Box& centers) const {
    const float extent = centers.hi[axis] - centers.lo[axis];
    const int bin = int((boxes[box].center()[axis] - centers.lo[axis]) / extent * N_BINS);
    return std::clamp(bin, 0, N_BINS - 1);
  }

  // cost of a side: surface times its number of leaves
  float side_cost(const Box& box, std::uint32_t count) const {
    return count == 0 ? 0.0f : box.half_area() * float((count + max_leaf - 1) / max_leaf);
  }

  void try_axis(const BinaryNode& node, int axis, const Box& centers, Split& best) const {
    std::array<Box, N_BINS> bin_boxes{};
    std::array<std::uint32_t, N_BINS> counts{};
    for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
      const int bin = bin_of(order[i], axis, centers);
      bin_boxes[bin].add(boxes[order[i]]);
      ++counts[bin];
    }
    std::array<float, N_BINS> right_cost{};
    Box right;
    std::uint32_t n_right = 0;
    for (int bin = N_BINS - 1; bin > 0; --bin) {
      right.add(bin_boxes[bin]);
      n_right += counts[bin];
      right_cost[bin] = side_cost(right, n_right);
    }
    Box left;
    std::uint32_t n_left = 0;
    for (int bin = 1; bin < N_BINS; ++bin) {
      left.add(bin_boxes[bin - 1]);
      n_left += counts[bin - 1];
      const float cost = side_cost(left, n_left) + right_cost[bin];
      if (n_left > 0 && n_left < node.count && cost < best.cost) best = {axis, bin, cost};
    }
  }

  // how many of the node's boxes go left
  std::uint32_t divide(const BinaryNode& node, int depth) {
    Box centers;
    for (std::uint32_t i = node.first; i < node.first + node.count; ++i) centers.add(boxes[order[i]].center());
    Split split;
    if (depth < MEDIAN_DEPTH)
      for (int axis = 0; axis < 3; ++axis)
        if (centers.hi[axis] > centers.lo[axis]) try_axis(node, axis, centers, split);
    const auto begin = order.begin() + node.first, end = begin + node.count;
    if (split.axis >= 0) {
      const auto middle = std::stable_partition(
          begin, end, [&](std::uint32_t box) { return bin_of(box, split.axis, centers) < split.bin; });
      return std::uint32_t(middle - begin);
    }
    int axis = 0;
    (centers.hi - centers.lo).maxCoeff(&axis);
    std::sort(begin, end, [&](std::uint32_t a, std::uint32_t b) {
      const float x = boxes[a].center()[axis], y = boxes[b].center()[axis];
      return x != y ? x < y : a < b;
    });
    return node.count / 2;
  }

  int build(std::uint32_t first, std::uint32_t count, int depth) {
    BinaryNode node;
    node.first = first;
    node.count = count;
    for (std::uint32_t i = first; i < first + count; ++i) node.box.add(boxes[order[i]]);
    if (count > max_leaf) {
      const std::uint32_t n_left = divide(node, depth);
      node.left = build(first, n_left, depth + 1);
      node.right = build(first + n_left, count - n_left, depth + 1);
    }
    nodes.push_back(node);
    return int(nodes.size()) - 1;
  }
};

// the up to eight binary nodes that stand below `root` in the wide tree
std::vector<int> open_children(const std::vector<BinaryNode>& nodes, int root) {
  std::vector<int> children = {root};
  while (children.size() < BVH_WIDTH) {
    int widest = -1;
    for (int k = 0; k < int(children.size()); ++k) {
      const BinaryNode& child = nodes[children[k]];
      if (child.left >= 0 && (widest < 0 || child.box.half_area() > nodes[children[widest]].box.half_area()))
        widest = k;
    }
    if (widest < 0) break;
    const BinaryNode& opened = nodes[children[widest]];
    children[widest] = opened.left;
    children.push_back(opened.right);
  }
  return children;
}

void set_slot(BvhNode& node, int k, const Box& box, int child) {
  node.lo_x[k] = box.lo.x();
  node.hi_x[k] = box.hi.x();
  node.lo_y[k] = box.lo.y();
  node.hi_y[k] = box.hi.y();
  node.lo_z[k] = box.lo.z();
  node.hi_z[k] = box.hi.z();
  node.child[k] = child;
}

BvhNode empty_node() {
  BvhNode node{};
  for (int k = 0; k < BVH_WIDTH; ++k) set_slot(node, k, Box{}, BVH_EMPTY);
  return node;
}

// most entries that a traversal below node i can have on its stack
int stack_need(const Bvh& bvh, int i) {
  int n_children = 0, deepest = 0;
  for (int k = 0; k < BVH_WIDTH; ++k) {
    const int child = bvh.nodes[i].child[k];
    if (child == BVH_EMPTY) continue;
    ++n_children;
    if (child >= 0) deepest = std::max(deepest, stack_need(bvh, child));
  }
  return std::max(n_children, n_children - 1 + deepest);
}

void collapse(const Builder& builder, int binary_root, Bvh& bvh) {
  std::vector<int> level = {binary_root};  // binary nodes, one per wide node of the level
  bvh.nodes = {empty_node()};
  bvh.level_first = {0};
  while (!level.empty()) {
    const std::uint32_t first = bvh.level_first.back();
    std::vector<int> next;
    bvh.level_first.push_back(std::uint32_t(bvh.nodes.size()));
    for (std::size_t i = 0; i < level.size(); ++i) {
      const std::vector<int> children = open_children(builder.nodes, level[i]);
      for (int k = 0; k < int(children.size()); ++k) {
        const BinaryNode& child = builder.nodes[children[k]];
        if (child.left < 0) {
          set_slot(bvh.nodes[first + i], k, child.box, ~int(bvh.leaves.size()));
          bvh.leaves.push_back({child.first, child.count});
        } else {
          set_slot(bvh.nodes[first + i], k, child.box, int(bvh.nodes.size()));
          bvh.nodes.push_back(empty_node());
          next.push_back(children[k]);
        }
      }
    }
    level = std::move(next);
  }
}

}  // namespace

Bvh build_bvh(std::span<const Box> boxes, unsigned max_leaf) {
  Bvh bvh;
  if (boxes.empty()) {
    bvh.nodes = {empty_node()};
    bvh.level_first = {0, 1};
    return bvh;
  }
  Builder builder{boxes, max_leaf, std::vector<std::uint32_t>(boxes.size()), {}};
  std::iota(builder.order.begin(), builder.order.end(), 0u);
  const int root = builder.build(0, std::uint32_t(boxes.size()), 0);
  collapse(builder, root, bvh);
  bvh.order = std::move(builder.order);
  bvh.stack_need = stack_need(bvh, 0);
  if (bvh.stack_need > BVH_STACK)
    throw Failure("the bounding volume hierarchy of a mesh with " + std::to_string(boxes.size()) + " triangles needs " +
                  std::to_string(bvh.stack_need) + " stack entries, the renderer has " + std::to_string(BVH_STACK) +
                  ": simplify or split the mesh");
  return bvh;
}

std::vector<Box> triangle_boxes(std::span<const Vec3f> points, std::span<const Triangle> triangles) {
  std::vector<Box> boxes(triangles.size());
  for (std::size_t i = 0; i < triangles.size(); ++i)
    for (const std::uint32_t corner : triangles[i]) boxes[i].add(points[corner]);
  return boxes;
}

std::vector<TriangleBlock> pack_blocks(const Bvh& bvh, std::span<const Vec3f> points,
                                       std::span<const Triangle> triangles, std::uint32_t first_triangle) {
  std::vector<TriangleBlock> blocks(bvh.leaves.size());
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    blocks[i] = TriangleBlock{};
    for (std::uint32_t& id : blocks[i].triangle) id = 0xffffffffu;
    for (std::uint32_t k = 0; k < bvh.leaves[i].count; ++k) {
      const std::uint32_t triangle = bvh.order[bvh.leaves[i].first + k];
      for (int corner = 0; corner < 3; ++corner)
        for (int axis = 0; axis < 3; ++axis)
          blocks[i].corner[corner][axis][k] = points[triangles[triangle][corner]][axis];
      blocks[i].triangle[k] = first_triangle + triangle;
    }
  }
  return blocks;
}

}  // namespace pvg
