#include "host/geometry/binary_tree.hpp"

#include <algorithm>
#include <array>
#include <cstring>

#include "host/base/workers.hpp"

namespace pvg {
namespace {

constexpr int N_BINS = 16, N_BINS_SMALL = 8;
constexpr std::uint32_t SMALL = 256;  // nodes with fewer boxes have fewer bins
constexpr std::uint32_t FEW = 8;      // nodes with no more boxes try every split
constexpr unsigned PAIR = 2;          // two triangles stay together: most are halves of a quadrilateral
constexpr int MEDIAN_DEPTH = 40;      // deeper than this the halves are made equal, so that the depth stays bounded

// A box and its index, which move together while they are sorted. Four numbers in one register; the last one of lo
// carries the index above the bits of 1.0, because denormal numbers are slow.
struct Item {
  Vec4f lo, hi;
  Item() = default;
  Item(const Box& box, std::uint32_t index) {
    float bits;
    index += ONE;
    std::memcpy(&bits, &index, sizeof bits);
    lo << box.lo.array(), bits;
    hi << box.hi.array(), 0;
  }
  static constexpr std::uint32_t ONE = 0x3f800000u;
  std::uint32_t index() const {
    std::uint32_t i;
    std::memcpy(&i, &lo.w(), sizeof i);
    return i - ONE;
  }
  Vec4f middle() const { return lo + hi; }  // twice the centre
};

struct Split {
  int axis = -1;  // -1: none is better than equal halves
  int bin = 0;
  float cost = 1e30f;
};

// cost of a side: surface times its number of leaves
float side_cost(const Box4& box, std::uint32_t count, unsigned max_leaf) {
  return count == 0 ? 0.0f : box.half_area() * float((count + max_leaf - 1) / max_leaf);
}

struct Bins {
  explicit Bins(int n_bins) {
    for (auto& axis : box) std::fill_n(axis.begin(), n_bins, Box4{});
    for (auto& axis : count) std::fill_n(axis.begin(), n_bins, 0u);
  }
  std::array<std::array<Box4, N_BINS>, 3> box;
  std::array<std::array<std::uint32_t, N_BINS>, 3> count;
};

class Builder {
 public:
  Builder(std::span<const Box> boxes, unsigned max_leaf)
      : max_leaf_(max_leaf), piece_size_(std::uint32_t(std::max<std::size_t>(1024, boxes.size() / 16))) {
    items_.reserve(boxes.size());
    for (std::uint32_t i = 0; i < boxes.size(); ++i) items_.emplace_back(boxes[i], i);
  }

  // the first levels node beside node, then the subtrees below them, each by one thread
  BinaryTree build() {
    BinaryTree tree;
    std::vector<BinaryNode>& nodes = tree.nodes;
    const std::uint32_t n = std::uint32_t(items_.size());
    if (n <= piece_size_) {
      build(0, n, 0, nodes);
      tree.parts = {0, int(nodes.size())};
      return tree;
    }
    Workers workers;
    nodes.emplace_back();
    std::vector<Piece> pieces;
    for (std::vector<Piece> level = {{0, 0, n, 0, {}}}; !level.empty();)
      level = split_level(workers, level, nodes, pieces);
    // the largest first, so that no thread is left with one at the end
    std::stable_sort(pieces.begin(), pieces.end(), [](const Piece& a, const Piece& b) { return a.count > b.count; });
    workers.run(pieces.size(), [&](std::size_t i) {
      pieces[i].nodes.reserve(pieces[i].count);
      build(pieces[i].first, pieces[i].count, pieces[i].depth, pieces[i].nodes);
    });
    nodes.reserve(n);
    tree.parts = {0, int(nodes.size())};
    for (const Piece& piece : pieces) {
      append(piece, nodes);
      tree.parts.push_back(int(nodes.size()));
    }
    return tree;
  }
  const std::vector<Item>& items() const { return items_; }

 private:
  struct Piece {  // a subtree that stands at nodes[at]
    int at;
    std::uint32_t first, count;
    int depth;
    std::vector<BinaryNode> nodes;
  };

  static void append(const Piece& piece, std::vector<BinaryNode>& nodes) {
    const int shift = int(nodes.size()) - 1;  // the piece's root takes the place that waits for it
    for (std::size_t i = 0; i < piece.nodes.size(); ++i) {
      BinaryNode node = piece.nodes[i];
      if (node.left >= 0) {
        node.left += shift;
        node.right += shift;
      }
      if (i == 0)
        nodes[piece.at] = node;
      else
        nodes.push_back(node);
    }
  }

  // bin = (middle - lo) * scale, within the bins
  static Eigen::Array4i bins_of(const Item& item, const Vec4f& lo, const Vec4f& scale, int n_bins) {
    return ((item.middle() - lo) * scale).max(0.0f).min(float(n_bins - 1)).cast<int>();
  }
  static int bin_of(const Item& item, int axis, float lo, float scale, int n_bins) {
    return int(std::min(std::max((item.lo[axis] + item.hi[axis] - lo) * scale, 0.0f), float(n_bins - 1)));
  }

  void try_axis(const Bins& bins, int axis, int n_bins, std::uint32_t count, Split& best) const {
    std::array<float, N_BINS> right_cost{};
    Box4 right;
    std::uint32_t n_right = 0;
    for (int bin = n_bins - 1; bin > 0; --bin) {
      right.add(bins.box[axis][bin]);
      n_right += bins.count[axis][bin];
      right_cost[bin] = side_cost(right, n_right, max_leaf_);
    }
    Box4 left;
    std::uint32_t n_left = 0;
    for (int bin = 1; bin < n_bins; ++bin) {
      left.add(bins.box[axis][bin - 1]);
      n_left += bins.count[axis][bin - 1];
      const float cost = side_cost(left, n_left, max_leaf_) + right_cost[bin];
      if (n_left > 0 && n_left < count && cost < best.cost) best = {axis, bin, cost};
    }
  }

  // Few boxes: every place on every axis is tried. How many go left.
  std::uint32_t divide_few(const BinaryNode& node) {
    const std::uint32_t n = node.count;
    Item* items = items_.data() + node.first;
    std::array<std::array<std::uint8_t, FEW>, 3> order;
    Split best;
    for (int axis = 0; axis < 3; ++axis) {
      std::array<float, FEW> middle;
      for (std::uint32_t i = 0; i < n; ++i) {
        const float m = items[i].middle()[axis];
        std::uint32_t j = i;
        for (; j > 0 && middle[j - 1] > m; --j) {
          middle[j] = middle[j - 1];
          order[axis][j] = order[axis][j - 1];
        }
        middle[j] = m;
        order[axis][j] = std::uint8_t(i);
      }
      std::array<float, FEW> right_cost;
      Box4 right, left;
      for (std::uint32_t i = n - 1; i > 0; --i) {
        right.add(items[order[axis][i]].lo, items[order[axis][i]].hi);
        right_cost[i] = side_cost(right, n - i, max_leaf_);
      }
      for (std::uint32_t i = 1; i < n; ++i) {
        left.add(items[order[axis][i - 1]].lo, items[order[axis][i - 1]].hi);
        const float cost = side_cost(left, i, max_leaf_) + right_cost[i];
        if (cost < best.cost) best = {axis, int(i), cost};
      }
    }
    if (best.axis < 0) return n / 2;  // boxes beyond all numbers
    std::array<Item, FEW> sorted;
    for (std::uint32_t i = 0; i < n; ++i) sorted[i] = items[order[best.axis][i]];
    std::copy_n(sorted.begin(), n, items);
    return std::uint32_t(best.bin);
  }

  // how many of the node's boxes go left; middles: box of twice their centres
  std::uint32_t divide(const BinaryNode& node, const Box4& middles, int depth) {
    if (node.count <= FEW) return divide_few(node);
    const auto begin = items_.begin() + node.first, end = begin + node.count;
    const int n_bins = node.count < SMALL ? N_BINS_SMALL : N_BINS;
    const Vec4f extent = middles.hi - middles.lo;
    const Vec4f scale = (extent > 0).select(float(n_bins) / extent, 0.0f);
    Split split;
    if (depth < MEDIAN_DEPTH) {
      Bins bins(n_bins);
      for (auto item = begin; item != end; ++item) {
        const Eigen::Array4i at = bins_of(*item, middles.lo, scale, n_bins);
        for (int axis = 0; axis < 3; ++axis) {
          bins.box[axis][at[axis]].add(item->lo, item->hi);
          ++bins.count[axis][at[axis]];
        }
      }
      for (int axis = 0; axis < 3; ++axis)
        if (extent[axis] > 0) try_axis(bins, axis, n_bins, node.count, split);
    }
    if (split.axis >= 0) {
      const float lo = middles.lo[split.axis], axis_scale = scale[split.axis];
      const auto goes_left = [&](const Item& item) {
        return bin_of(item, split.axis, lo, axis_scale, n_bins) < split.bin;
      };
      return std::uint32_t(std::partition(begin, end, goes_left) - begin);
    }
    int axis = 0;
    extent.head<3>().maxCoeff(&axis);
    std::nth_element(begin, begin + node.count / 2, end, [&](const Item& a, const Item& b) {
      const float x = a.middle()[axis], y = b.middle()[axis];
      return x != y ? x < y : a.index() < b.index();
    });
    return node.count / 2;
  }

  // the node over some boxes, which stand sorted after it: n_left of them are its left child's, 0: it is a leaf
  BinaryNode make_node(std::uint32_t first, std::uint32_t count, int depth, std::uint32_t& n_left) {
    BinaryNode node;
    node.first = first;
    node.count = count;
    Box4 middles;
    for (std::uint32_t i = first; i < first + count; ++i) {
      const Vec4f middle = items_[i].middle();
      node.box.add(items_[i].lo, items_[i].hi);
      middles.add(middle, middle);
    }
    n_left = count > std::min(max_leaf_, PAIR) ? divide(node, middles, depth) : 0;
    return node;
  }

  // the next level's nodes; those that are small enough go to `pieces`
  std::vector<Piece> split_level(Workers& workers, const std::vector<Piece>& level, std::vector<BinaryNode>& nodes,
                                 std::vector<Piece>& pieces) {
    std::vector<BinaryNode> made(level.size());
    std::vector<std::uint32_t> n_left(level.size());
    workers.run(level.size(),
                [&](std::size_t i) { made[i] = make_node(level[i].first, level[i].count, level[i].depth, n_left[i]); });
    std::vector<Piece> next;
    for (std::size_t i = 0; i < level.size(); ++i) {
      const auto& [at, first, count, depth, none] = level[i];
      made[i].left = int(nodes.size());
      made[i].right = int(nodes.size() + 1);
      nodes[at] = made[i];
      nodes.resize(nodes.size() + 2);
      const Piece left{made[i].left, first, n_left[i], depth + 1, {}};
      const Piece right{made[i].right, first + n_left[i], count - n_left[i], depth + 1, {}};
      for (const Piece& piece : {left, right}) (piece.count <= piece_size_ ? pieces : next).push_back(piece);
    }
    return next;
  }

  int build(std::uint32_t first, std::uint32_t count, int depth, std::vector<BinaryNode>& nodes) {
    const int at = int(nodes.size());
    nodes.emplace_back();
    std::uint32_t n_left = 0;
    BinaryNode node = make_node(first, count, depth, n_left);
    if (n_left > 0) {
      node.left = build(first, n_left, depth + 1, nodes);
      node.right = build(first + n_left, count - n_left, depth + 1, nodes);
    }
    nodes[at] = node;
    return at;
  }

  unsigned max_leaf_;
  std::uint32_t piece_size_;  // subtrees with no more boxes are built by one thread
  std::vector<Item> items_;
};

}  // namespace

BinaryTree build_binary_tree(std::span<const Box> boxes, unsigned max_leaf) {
  Builder builder(boxes, max_leaf);
  BinaryTree tree = builder.build();
  tree.order.reserve(boxes.size());
  for (const Item& item : builder.items()) tree.order.push_back(item.index());
  return tree;
}

}  // namespace pvg
