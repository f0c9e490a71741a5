#include "host/geometry/reinsertion.hpp"

#include <algorithm>

namespace pvg {
namespace {

constexpr int N_ROUNDS = 4;
constexpr std::size_t MOST_PER_ROUND = 100000;  // subtrees that are tried, those of the largest boxes
constexpr float ROUNDING = 1e-5f;               // gains below this share of a box are none
constexpr int ROOT = 0, NONE = -1;

Box4 joined(Box4 a, const Box4& b) {
  a.add(b);
  return a;
}

class Reinsertion {
 public:
  explicit Reinsertion(std::vector<BinaryNode>& nodes) : nodes_(nodes), parent_(nodes.size(), NONE) {
    for (int i = 0; i < int(nodes_.size()); ++i)
      if (nodes_[i].left >= 0) parent_[nodes_[i].left] = parent_[nodes_[i].right] = i;
  }

  void round() {
    std::vector<std::pair<float, int>> tried;  // minus the area, so that the largest comes first
    for (int i = 1; i < int(nodes_.size()); ++i) tried.emplace_back(-nodes_[i].box.half_area(), i);
    const std::size_t n = std::min(MOST_PER_ROUND, tried.size());
    std::partial_sort(tried.begin(), tried.begin() + std::ptrdiff_t(n), tried.end());
    for (std::size_t k = 0; k < n; ++k) {
      const int i = tried[k].second;
      if (parent_[i] == ROOT) continue;  // the root stays where it is, with its children
      const int place = best_place(i);
      if (place != NONE) move(i, place);
    }
  }

 private:
  struct Visit {
    int node;
    float saved;  // area that is saved elsewhere if the subtree goes beside this node
  };
  struct Place {
    int beside = NONE;
    float gain;  // area saved less that of the new node
  };

  int sibling(int i) const {
    const BinaryNode& parent = nodes_[parent_[i]];
    return parent.left == i ? parent.right : parent.left;
  }

  // looks at all places beside what stack_ holds and below
  void search(const Box4& box, Place& best) {
    const float own = box.half_area();
    while (!stack_.empty()) {
      const Visit visit = stack_.back();
      stack_.pop_back();
      if (visit.saved - own <= best.gain) continue;
      const BinaryNode& node = nodes_[visit.node];
      const float gain = visit.saved - joined(node.box, box).half_area();
      if (gain > best.gain) best = {visit.node, gain};
      if (node.left >= 0) push_children(node, gain + node.box.half_area());
    }
  }
  void push_children(const BinaryNode& node, float saved) {
    stack_.push_back({node.left, saved});
    stack_.push_back({node.right, saved});
  }

  // The node beside which subtree i shall stand, NONE: it stands best where it is. Without i its parent goes, and the
  // nodes above that shrink as far up as the new place is not below them.
  int best_place(int i) {
    const Box4 box = nodes_[i].box;
    int pivot = parent_[i];
    float saved = nodes_[pivot].box.half_area();
    Place best{NONE, ROUNDING * saved};
    const BinaryNode& beside = nodes_[sibling(i)];
    Box4 rest = beside.box;  // of the pivot without i
    if (beside.left >= 0) push_children(beside, saved + rest.half_area() - joined(rest, box).half_area());
    search(box, best);
    for (; pivot != ROOT; pivot = parent_[pivot]) {
      const int other = sibling(pivot), up = parent_[pivot];
      stack_.push_back({other, saved});
      search(box, best);
      rest.add(nodes_[other].box);
      const float area = nodes_[up].box.half_area();
      saved += area - rest.half_area();
      if (up != ROOT && saved - area > best.gain) best = {up, saved - area};
    }
    return best.beside;
  }

  void replace_child(int parent, int old_child, int new_child) {
    BinaryNode& node = nodes_[parent];
    (node.left == old_child ? node.left : node.right) = new_child;
    parent_[new_child] = parent;
  }

  void refit_from(int i) {
    for (; i != NONE; i = parent_[i]) nodes_[i].box = joined(nodes_[nodes_[i].left].box, nodes_[nodes_[i].right].box);
  }

  // the node of the old parent becomes that of the new one
  void move(int i, int place) {
    const int joint = parent_[i], above = parent_[joint];
    replace_child(above, joint, sibling(i));
    replace_child(parent_[place], place, joint);
    nodes_[joint].left = place;
    nodes_[joint].right = i;
    parent_[place] = parent_[i] = joint;
    refit_from(above);
    refit_from(joint);
  }

  std::vector<BinaryNode>& nodes_;
  std::vector<int> parent_;
  std::vector<Visit> stack_;
};

// nodes in the order of a walk, and the boxes' indices in that of the leaves
struct Renumbering {
  const BinaryTree& old;
  BinaryTree made;

  int add(int i) {
    const int at = int(made.nodes.size());
    made.nodes.push_back(old.nodes[i]);
    made.nodes[at].first = std::uint32_t(made.order.size());
    if (old.nodes[i].left < 0) {
      const auto first = old.order.begin() + old.nodes[i].first;
      made.order.insert(made.order.end(), first, first + old.nodes[i].count);
    } else {
      const int left = add(old.nodes[i].left), right = add(old.nodes[i].right);
      made.nodes[at].left = left;
      made.nodes[at].right = right;
    }
    made.nodes[at].count = std::uint32_t(made.order.size()) - made.nodes[at].first;
    return at;
  }
};

}  // namespace

double inner_area(const BinaryTree& tree) {
  double sum = 0;
  for (const BinaryNode& node : tree.nodes)
    if (node.left >= 0) sum += node.box.half_area();
  return sum;
}

void reinsert_subtrees(BinaryTree& tree) {
  Reinsertion reinsertion(tree.nodes);
  for (int i = 0; i < N_ROUNDS; ++i) reinsertion.round();
  Renumbering renumbering{tree, {}};
  renumbering.made.nodes.reserve(tree.nodes.size());
  renumbering.made.order.reserve(tree.order.size());
  renumbering.add(ROOT);
  renumbering.made.parts = {0, int(tree.nodes.size())};
  tree = std::move(renumbering.made);
}

}  // namespace pvg
