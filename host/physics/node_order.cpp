#include "host/physics/node_order.hpp"

#include <Eigen/OrderingMethods>
#include <Eigen/SparseCore>

namespace pvg {
namespace {

// The nodes of the part that `start` lies in, nearest first. seen[node] == mark: found by this search or left out.
std::vector<u32> breadth_first(const NodeGraph& graph, u32 start, std::vector<u32>& seen, u32 mark) {
  std::vector<u32> found{start};
  seen[start] = mark;
  for (std::size_t i = 0; i < found.size(); ++i)
    for (u32 k = graph.first[found[i]]; k < graph.first[found[i] + 1]; ++k) {
      const u32 next = graph.neighbour[k];
      if (seen[next] == mark) continue;
      seen[next] = mark;
      found.push_back(next);
    }
  return found;
}

}  // namespace

std::vector<u32> minimum_degree_order(const NodeGraph& graph) {
  const u32 n = graph.n_nodes();
  if (n == 0) return {};
  std::vector<Eigen::Triplet<double>> entries;
  for (u32 node = 0; node < n; ++node) {
    entries.emplace_back(node, node, 1);
    for (u32 k = graph.first[node]; k < graph.first[node + 1]; ++k) entries.emplace_back(graph.neighbour[k], node, 1);
  }
  Eigen::SparseMatrix<double> pattern(n, n);
  pattern.setFromTriplets(entries.begin(), entries.end());
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> order;
  Eigen::AMDOrdering<int>()(pattern, order);
  return {order.indices().begin(), order.indices().end()};
}

std::vector<u32> two_ended_sweep(const NodeGraph& graph) {
  std::vector<u32> order, seen(graph.n_nodes(), 0);
  u32 mark = 0;
  for (u32 node = 0; node < graph.n_nodes(); ++node) {
    if (seen[node] != 0) continue;
    // the last node found is far from the first; twice, and the first is far out too
    std::vector<u32> nodes = breadth_first(graph, node, seen, ++mark);
    for (int i = 0; i < 2; ++i) nodes = breadth_first(graph, nodes.back(), seen, ++mark);
    const std::vector<u32> back = breadth_first(graph, nodes.back(), seen, ++mark);
    const u32 half = u32(nodes.size() / 2), taken = ++mark;
    for (u32 i = 0; i < half; ++i) {
      order.push_back(nodes[i]);
      seen[nodes[i]] = taken;
    }
    for (const u32 other : back)
      if (seen[other] != taken) order.push_back(other);
  }
  return order;
}

}  // namespace pvg
