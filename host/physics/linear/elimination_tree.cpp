#include "host/physics/linear/elimination_tree.hpp"

#include <algorithm>
#include <numeric>

#include "host/physics/linear/node_order.hpp"

namespace pvg {
namespace {

NodeGraph graph_of(const BlockPattern& pattern) {
  const u32 n = pattern.n_nodes();
  NodeGraph graph;
  graph.first.assign(n + 1, 0);
  const auto for_each_edge = [&](const auto& found) {
    for (u32 column = 0; column < n; ++column)
      for (u32 k = pattern.column_first[column]; k < pattern.column_first[column + 1]; ++k)
        if (pattern.row[k] != column) found(pattern.row[k], column), found(column, pattern.row[k]);
  };
  for_each_edge([&](u32 from, u32) { ++graph.first[from + 1]; });
  std::partial_sum(graph.first.begin(), graph.first.end(), graph.first.begin());
  graph.neighbour.resize(graph.first[n]);
  std::vector<u32> next(graph.first.begin(), graph.first.end() - 1);
  for_each_edge([&](u32 from, u32 to) { graph.neighbour[next[from]++] = to; });
  return graph;
}

// Time to factor and assemble one supernode, in units of one floating point operation of a large product: below a
// depth of some 12 the product waits for memory, each number passed to the parent costs about 10, a supernode 5000.
double predicted_cost(double n_pivots, double n_rows) {
  const double p = 3 * n_pivots, r = 3 * n_rows;
  return p * p * p / 3 + p * p * r + p * r * r + 10 * (r * r / 2 + p * p / 2 + p * r) + 5000;
}

// A supernode before it has its place in the order: positions are those of the fill-reducing order.
struct Front {
  std::vector<u32> pivots, rows, children;
  bool is_merged = false;
};

double cost(const Front& front) { return predicted_cost(double(front.pivots.size()), double(front.rows.size())); }

// One front for each node: its rows are those of the matrix and those its children pass on.
std::vector<Front> fronts_of_nodes(const NodeGraph& graph, const std::vector<u32>& order) {
  const u32 n = graph.n_nodes();
  std::vector<u32> position(n), seen(n, NO_PARENT);
  for (u32 i = 0; i < n; ++i) position[order[i]] = i;
  std::vector<Front> fronts(n);
  for (u32 i = 0; i < n; ++i) {
    Front& front = fronts[i];
    front.pivots = {i};
    seen[i] = i;
    const auto add = [&](u32 row) {
      if (row < i || seen[row] == i) return;
      seen[row] = i;
      front.rows.push_back(row);
    };
    for (u32 k = graph.first[order[i]]; k < graph.first[order[i] + 1]; ++k) add(position[graph.neighbour[k]]);
    for (const u32 child : front.children)
      for (const u32 row : fronts[child].rows) add(row);
    std::sort(front.rows.begin(), front.rows.end());
    if (!front.rows.empty()) fronts[front.rows[0]].children.push_back(i);
  }
  return fronts;
}

// Merges a front into its parent where that is predicted to be faster: fewer numbers are passed on, products are
// deeper, but some zeros are kept.
void merge_fronts(std::vector<Front>& fronts) {
  for (Front& parent : fronts) {
    std::vector<u32> waiting = parent.children;
    parent.children.clear();
    std::sort(waiting.begin(), waiting.end(),
              [&](u32 a, u32 b) { return std::pair(fronts[a].rows.size(), a) > std::pair(fronts[b].rows.size(), b); });
    for (const u32 c : waiting) {
      Front& child = fronts[c];
      const double merged =
          predicted_cost(double(parent.pivots.size() + child.pivots.size()), double(parent.rows.size()));
      if (merged > cost(parent) + cost(child)) {
        parent.children.push_back(c);
        continue;
      }
      parent.pivots.insert(parent.pivots.begin(), child.pivots.begin(), child.pivots.end());
      parent.children.insert(parent.children.end(), child.children.begin(), child.children.end());
      child.is_merged = true;
    }
  }
}

// Gives the remaining fronts their places, children before parents, each subtree in one piece.
EliminationTree tree_of(const std::vector<Front>& fronts, const std::vector<u32>& order) {
  const u32 n = u32(order.size());
  EliminationTree tree;
  std::vector<u32> roots, moved(n);  // moved: fill-reducing to final position
  for (u32 i = 0; i < n; ++i)
    if (!fronts[i].is_merged && fronts[i].rows.empty()) roots.push_back(i);
  std::vector<u32> number(n, NO_PARENT), stack(roots.rbegin(), roots.rend());
  while (!stack.empty()) {
    const u32 i = stack.back();
    const bool is_entered = number[i] == NO_PARENT;
    if (is_entered) {
      number[i] = n;  // entered; the number follows when the children are done
      stack.insert(stack.end(), fronts[i].children.rbegin(), fronts[i].children.rend());
      continue;
    }
    stack.pop_back();
    number[i] = u32(tree.supernodes.size());
    Supernode& node = tree.supernodes.emplace_back();
    node.first = u32(tree.order.size());
    node.n_pivots = u32(fronts[i].pivots.size());
    node.cost = cost(fronts[i]);
    tree.cost += node.cost;
    for (const u32 pivot : fronts[i].pivots) moved[pivot] = u32(tree.order.size()), tree.order.push_back(order[pivot]);
    node.rows = fronts[i].rows;
    for (const u32 child : fronts[i].children) node.children.push_back(number[child]);
  }
  for (u32 s = 0; s < tree.supernodes.size(); ++s) {
    for (u32& row : tree.supernodes[s].rows) row = moved[row];
    std::sort(tree.supernodes[s].rows.begin(), tree.supernodes[s].rows.end());
    for (const u32 child : tree.supernodes[s].children) tree.supernodes[child].parent = s;
  }
  tree.position.resize(n);
  for (u32 i = 0; i < n; ++i) tree.position[tree.order[i]] = i;
  return tree;
}

}  // namespace

EliminationTree eliminate(const BlockPattern& pattern, std::span<const Vec3> position,
                          std::optional<NodeOrder> wanted) {
  const NodeGraph graph = graph_of(pattern);
  EliminationTree best;
  for (const NodeOrder kind : {NodeOrder::minimum_degree, NodeOrder::two_ended_sweep, NodeOrder::nested_dissection}) {
    if (wanted && kind != *wanted) continue;
    if (kind == NodeOrder::nested_dissection && position.empty()) continue;
    const std::vector<u32> order = kind == NodeOrder::minimum_degree    ? minimum_degree_order(graph)
                                   : kind == NodeOrder::two_ended_sweep ? two_ended_sweep(graph)
                                                                        : nested_dissection(graph, position);
    std::vector<Front> fronts = fronts_of_nodes(graph, order);
    merge_fronts(fronts);
    EliminationTree tree = tree_of(fronts, order);
    tree.kind = kind;
    if (best.order.empty() || tree.cost < best.cost) best = std::move(tree);
  }
  return best;
}

}  // namespace pvg
