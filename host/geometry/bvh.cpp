#include "host/geometry/bvh.hpp"

#include <algorithm>
#include <array>
#include <string>

#include "host/base/error.hpp"
#include "host/base/workers.hpp"
#include "host/geometry/binary_tree.hpp"
#include "host/geometry/reinsertion.hpp"

namespace pvg {
namespace {

// f(first, last) of parts of 0 .. n - 1, by several threads where there are several parts
template <class Function>
void in_parts(std::size_t n, std::size_t size, const Function& f) {
  const std::size_t n_parts = (n + size - 1) / size;
  if (n_parts <= 1) {
    if (n > 0) f(0, n);
    return;
  }
  Workers workers;
  workers.run(n_parts, [&](std::size_t k) { f(k * size, std::min(n, (k + 1) * size)); });
}

constexpr std::size_t TRIANGLES_PER_TASK = 16384;

// Which binary nodes stand side by side in a wide node, and which become leaves: the choice of least total cost
// (Ylitie, Karras, Laine 2017, "Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs"). cost(n, j):
// of subtree n as at most j trees,
//   cost(n, 1) = min(BVH_NODE_COST A + shared(n, 8), BVH_LEAF_COST A if it is small enough)
//   cost(n, j) = min(cost(n, j - 1), shared(n, j)),   shared(n, j) = min over k of cost(left, k) + cost(right, j - k)
class Widening {
 public:
  Widening(const BinaryTree& tree, unsigned max_leaf)
      : nodes_(tree.nodes), max_leaf_(max_leaf), choices_(nodes_.size()), cost_(nodes_.size()) {
    in_parts(tree.parts.size() - 2, 1,
             [&](std::size_t k, std::size_t) { choose(tree.parts[k + 1], tree.parts[k + 2]); });
    choose(0, tree.parts[1]);
  }

  bool is_leaf(int node) const { return choices_[node][1] == LEAF; }

  // the up to eight binary nodes below `root` in the wide tree
  std::vector<int> children(int root) const {
    std::vector<int> found;
    if (is_leaf(root))
      found.push_back(root);
    else
      collect_sides(root, BVH_WIDTH, found);
    return found;
  }

 private:
  static constexpr std::uint8_t FEWER = 0, LEAF = 1;  // [j > 1] one tree fewer is as good; [1] it is a leaf

  // of nodes first .. last - 1, whose children beyond them have chosen
  void choose(int first, int last) {
    std::vector<std::array<float, BVH_WIDTH + 1>>& cost = cost_;
    for (int i = last; i-- > first;) {
      const float area = nodes_[i].box.half_area();
      if (nodes_[i].left < 0) {
        cost[i].fill(BVH_LEAF_COST * area);
        choices_[i][1] = LEAF;
        continue;
      }
      share(i);
      cost[i][1] = BVH_NODE_COST * area + cost[i][BVH_WIDTH];
      if (nodes_[i].count <= max_leaf_ && BVH_LEAF_COST * area <= cost[i][1]) {
        cost[i][1] = BVH_LEAF_COST * area;
        choices_[i][1] = LEAF;
      }
      for (int j = 2; j < BVH_WIDTH; ++j)  // eight are the node's own children and stay
        if (cost[i][j - 1] <= cost[i][j]) {
          cost[i][j] = cost[i][j - 1];
          choices_[i][j] = FEWER;
        }
    }
  }

  void share(int i) {
    std::vector<std::array<float, BVH_WIDTH + 1>>& cost = cost_;
    for (int j = BVH_WIDTH; j > 1; --j) {
      cost[i][j] = 1e30f;
      for (int k = 1; k < j; ++k) {
        const float sum = cost[nodes_[i].left][k] + cost[nodes_[i].right][j - k];
        if (sum < cost[i][j]) {
          cost[i][j] = sum;
          choices_[i][j] = std::uint8_t(k);
        }
      }
    }
  }

  void collect(int node, int n_trees, std::vector<int>& found) const {
    while (n_trees > 1 && choices_[node][n_trees] == FEWER) --n_trees;
    if (n_trees == 1)
      found.push_back(node);
    else
      collect_sides(node, n_trees, found);
  }
  void collect_sides(int node, int n_trees, std::vector<int>& found) const {
    const int n_left = std::max<int>(1, choices_[node][n_trees]);
    collect(nodes_[node].left, n_left, found);
    collect(nodes_[node].right, n_trees - n_left, found);
  }

  const std::vector<BinaryNode>& nodes_;
  unsigned max_leaf_;
  std::vector<std::array<std::uint8_t, BVH_WIDTH + 1>> choices_;  // [j] trees of the left child
  std::vector<std::array<float, BVH_WIDTH + 1>> cost_;
};

void set_slot(BvhNode& node, int k, const Box4& box, int child) {
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
  for (int k = 0; k < BVH_WIDTH; ++k) set_slot(node, k, Box4{}, BVH_EMPTY);
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

void widen(const BinaryTree& tree, unsigned max_leaf, Bvh& bvh) {
  const std::vector<BinaryNode>& nodes = tree.nodes;
  const Widening widening(tree, max_leaf);
  std::vector<int> level = {0};  // binary nodes, one per wide node of the level
  bvh.nodes = {empty_node()};
  bvh.level_first = {0};
  while (!level.empty()) {
    const std::uint32_t first = bvh.level_first.back();
    std::vector<int> next;
    bvh.level_first.push_back(std::uint32_t(bvh.nodes.size()));
    for (std::size_t i = 0; i < level.size(); ++i) {
      const std::vector<int> children = widening.children(level[i]);
      for (int k = 0; k < int(children.size()); ++k) {
        const BinaryNode& child = nodes[children[k]];
        if (widening.is_leaf(children[k])) {
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

TriangleBlock pack_block(const Bvh& bvh, const Bvh::Leaf& leaf, std::span<const Vec3f> points,
                         std::span<const Triangle> triangles, std::uint32_t first_triangle) {
  TriangleBlock block{};
  for (std::uint32_t& id : block.triangle) id = 0xffffffffu;
  for (std::uint32_t k = 0; k < leaf.count; ++k) {
    const std::uint32_t triangle = bvh.order[leaf.first + k];
    for (int corner = 0; corner < 3; ++corner)
      for (int axis = 0; axis < 3; ++axis) block.corner[corner][axis][k] = points[triangles[triangle][corner]][axis];
    block.triangle[k] = first_triangle + triangle;
  }
  return block;
}

}  // namespace

Bvh build_bvh(std::span<const Box> boxes, unsigned max_leaf, TreeQuality quality) {
  Bvh bvh;
  if (boxes.empty()) {
    bvh.nodes = {empty_node()};
    bvh.level_first = {0, 1};
    return bvh;
  }
  BinaryTree tree = build_binary_tree(boxes, max_leaf);
  if (quality == TreeQuality::thorough) reinsert_subtrees(tree);
  widen(tree, max_leaf, bvh);
  bvh.order = std::move(tree.order);
  bvh.stack_need = stack_need(bvh, 0);
  // reinsertion does not bound the depth, the builder does
  if (bvh.stack_need > BVH_STACK && quality == TreeQuality::thorough)
    return build_bvh(boxes, max_leaf, TreeQuality::fast);
  if (bvh.stack_need > BVH_STACK)
    throw Failure("the bounding volume hierarchy of a mesh with " + std::to_string(boxes.size()) + " triangles needs " +
                  std::to_string(bvh.stack_need) + " stack entries, the renderer has " + std::to_string(BVH_STACK) +
                  ": simplify or split the mesh");
  return bvh;
}

std::vector<Box> triangle_boxes(std::span<const Vec3f> points, std::span<const Triangle> triangles) {
  std::vector<Box> boxes(triangles.size());
  in_parts(triangles.size(), TRIANGLES_PER_TASK, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i)
      for (const std::uint32_t corner : triangles[i]) boxes[i].add(points[corner]);
  });
  return boxes;
}

std::vector<TriangleBlock> pack_blocks(const Bvh& bvh, std::span<const Vec3f> points,
                                       std::span<const Triangle> triangles, std::uint32_t first_triangle) {
  std::vector<TriangleBlock> blocks(bvh.leaves.size());
  in_parts(blocks.size(), TRIANGLES_PER_TASK / 4, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i)
      blocks[i] = pack_block(bvh, bvh.leaves[i], points, triangles, first_triangle);
  });
  return blocks;
}

}  // namespace pvg
