// Subtrees that are put elsewhere: the best tree of four boxes by hand, and what must hold of any tree.
#include "host/geometry/reinsertion.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace pvg {
namespace {

Box4 cube_at(float x) {
  Box4 box;
  box.add(Vec4f(x, 0, 0, 0), Vec4f(x + 1, 1, 1, 0));
  return box;
}

BinaryNode leaf(const Box4& box, std::uint32_t first) {
  BinaryNode node;
  node.box = box;
  node.first = first;
  node.count = 1;
  return node;
}

// cubes at 0 and 100 under one node, at 1 and 101 under the other
BinaryTree crossed_tree() {
  BinaryTree tree;
  tree.nodes.resize(3);
  for (const float x : {0.0f, 100.0f, 1.0f, 101.0f})
    tree.nodes.push_back(leaf(cube_at(x), std::uint32_t(tree.nodes.size()) - 3));
  const auto join = [&](int i, int left, int right) {
    BinaryNode& node = tree.nodes[std::size_t(i)];
    node.left = left;
    node.right = right;
    node.box = tree.nodes[std::size_t(left)].box;
    node.box.add(tree.nodes[std::size_t(right)].box);
  };
  join(1, 3, 4);
  join(2, 5, 6);
  join(0, 1, 2);
  tree.nodes[0].count = 4;
  tree.nodes[1].count = tree.nodes[2].count = 2;
  tree.nodes[2].first = 2;
  tree.order = {0, 1, 2, 3};
  tree.parts = {0, 7};
  return tree;
}

TEST(Reinsertion, NeighboursComeTogether) {
  BinaryTree tree = crossed_tree();
  // half areas: 102 x 1 x 1 has 205, 101 x 1 x 1 has 203, 2 x 1 x 1 has 5
  EXPECT_FLOAT_EQ(float(inner_area(tree)), 205 + 203 + 203);
  reinsert_subtrees(tree);
  EXPECT_FLOAT_EQ(float(inner_area(tree)), 205 + 5 + 5);
}

TEST(Reinsertion, ATreeOfRandomBoxesGetsCheaperAndLosesNothing) {
  std::mt19937 random(5);
  std::uniform_real_distribution<float> place(0, 10), size(0, 1);
  std::vector<Box> boxes(3000);
  for (Box& box : boxes) {
    const Vec3f lo(place(random), place(random), place(random));
    box.add(lo);
    box.add(Vec3f(lo + Vec3f(size(random), size(random), size(random))));
  }
  BinaryTree tree = build_binary_tree(boxes, 4);
  const double before = inner_area(tree);
  reinsert_subtrees(tree);
  EXPECT_LT(inner_area(tree), 0.99 * before);
  std::vector<std::uint32_t> sorted = tree.order;
  std::sort(sorted.begin(), sorted.end());
  for (std::uint32_t i = 0; i < boxes.size(); ++i) ASSERT_EQ(sorted[i], i);
  for (int i = 0; i < int(tree.nodes.size()); ++i) {
    const BinaryNode& node = tree.nodes[std::size_t(i)];
    for (std::uint32_t k = node.first; k < node.first + node.count; ++k)
      for (int axis = 0; axis < 3; ++axis) {
        const Box& box = boxes[tree.order[k]];
        ASSERT_TRUE(node.box.lo[axis] <= box.lo[axis] && box.hi[axis] <= node.box.hi[axis]);
      }
    if (node.left < 0) continue;
    const BinaryNode &left = tree.nodes[std::size_t(node.left)], &right = tree.nodes[std::size_t(node.right)];
    EXPECT_TRUE(node.left > i && node.right > i);
    EXPECT_EQ(left.first, node.first);
    EXPECT_EQ(right.first, left.first + left.count);
    EXPECT_EQ(node.count, left.count + right.count);
  }
}

TEST(Reinsertion, OneBoxAndTwoStay) {
  for (const std::size_t n : {std::size_t(1), std::size_t(2)}) {
    BinaryTree tree = build_binary_tree(std::vector<Box>(n, Box{Vec3f::Zero(), Vec3f::Ones()}), 4);
    const double before = inner_area(tree);
    reinsert_subtrees(tree);
    EXPECT_EQ(inner_area(tree), before);
    EXPECT_EQ(tree.order.size(), n);
  }
}

}  // namespace
}  // namespace pvg
