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
  u32 n_rows = 0;  // that it will have
  bool is_merged = false;
};

double cost(const Front& front) { return predicted_cost(double(front.pivots.size()), double(front.n_rows)); }

std::vector<u32> inverse(const std::vector<u32>& order) {
  std::vector<u32> position(order.size());
  for (u32 i = 0; i < order.size(); ++i) position[order[i]] = i;
  return position;
}

// One front for each node, which knows how many rows it has, not yet which: row i of the factor holds the nodes on the
// ways from the earlier neighbours of i up to i in the elimination tree.
std::vector<Front> fronts_of_nodes(const NodeGraph& graph, const std::vector<u32>& order,
                                   const std::vector<u32>& position) {
  const u32 n = graph.n_nodes();
  std::vector<u32> parent(n, NO_PARENT), seen(n, NO_PARENT);
  std::vector<Front> fronts(n);
  for (u32 i = 0; i < n; ++i) {
    fronts[i].pivots = {i};
    seen[i] = i;
    for (u32 k = graph.first[order[i]]; k < graph.first[order[i] + 1]; ++k)
      for (u32 j = position[graph.neighbour[k]]; j < i && seen[j] != i; j = parent[j]) {
        if (parent[j] == NO_PARENT) parent[j] = i;
        ++fronts[j].n_rows;
        seen[j] = i;
      }
  }
  for (u32 i = 0; i < n; ++i)
    if (parent[i] != NO_PARENT) fronts[parent[i]].children.push_back(i);
  return fronts;
}

// Merges a front into its parent where that is predicted to be faster: fewer numbers are passed on, products are
// deeper, but some zeros are kept.
void merge_fronts(std::vector<Front>& fronts) {
  for (Front& parent : fronts) {
    std::vector<u32> waiting = parent.children;
    parent.children.clear();
    std::sort(waiting.begin(), waiting.end(),
              [&](u32 a, u32 b) { return std::pair(fronts[a].n_rows, a) > std::pair(fronts[b].n_rows, b); });
    for (const u32 c : waiting) {
      Front& child = fronts[c];
      const double merged = predicted_cost(double(parent.pivots.size() + child.pivots.size()), double(parent.n_rows));
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

// The rows of each remaining front: neighbours of its pivots, and what its children pass on, behind its last pivot.
void find_rows(const NodeGraph& graph, const std::vector<u32>& order, const std::vector<u32>& position,
               std::vector<Front>& fronts) {
  std::vector<u32> seen(fronts.size(), NO_PARENT);
  for (u32 i = 0; i < fronts.size(); ++i) {
    Front& front = fronts[i];
    if (front.is_merged) continue;
    front.rows.reserve(front.n_rows);
    const auto add = [&](u32 row) {
      if (row <= i || seen[row] == i) return;
      seen[row] = i;
      front.rows.push_back(row);
    };
    for (const u32 pivot : front.pivots)
      for (u32 k = graph.first[order[pivot]]; k < graph.first[order[pivot] + 1]; ++k) add(position[graph.neighbour[k]]);
    for (const u32 child : front.children)
      for (const u32 row : fronts[child].rows) add(row);
  }
}

// Gives the remaining fronts their places, children before parents, each subtree in one piece.
EliminationTree tree_of(std::vector<Front> fronts, const std::vector<u32>& order) {
  const u32 n = u32(order.size());
  EliminationTree tree;
  std::vector<u32> roots, moved(n);  // moved: fill-reducing to final position
  for (u32 i = 0; i < n; ++i)
    if (!fronts[i].is_merged && fronts[i].n_rows == 0) roots.push_back(i);
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
    node.rows = std::move(fronts[i].rows);
    for (const u32 child : fronts[i].children) node.children.push_back(number[child]);
  }
  for (u32 s = 0; s < tree.supernodes.size(); ++s) {
    for (u32& row : tree.supernodes[s].rows) row = moved[row];
    std::sort(tree.supernodes[s].rows.begin(), tree.supernodes[s].rows.end());
    for (const u32 child : tree.supernodes[s].children) tree.supernodes[child].parent = s;
  }
  tree.position = inverse(tree.order);
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
    const std::vector<u32> position_of = inverse(order);
    std::vector<Front> fronts = fronts_of_nodes(graph, order, position_of);
    merge_fronts(fronts);
    find_rows(graph, order, position_of, fronts);
    EliminationTree tree = tree_of(std::move(fronts), order);
    tree.kind = kind;
    if (best.order.empty() || tree.cost < best.cost) best = std::move(tree);
  }
  return best;
}

}  // namespace pvg
