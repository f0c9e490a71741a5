#include "host/physics/linear/node_order.hpp"

#include <Eigen/OrderingMethods>
#include <Eigen/SparseCore>
#include <algorithm>
#include <limits>
#include <numeric>
#include <tuple>

namespace pvg {
namespace {

constexpr std::size_t SMALL_PART = 64;  // nodes: not worth cutting any further
constexpr u32 CUT_OFF = ~0u;

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

namespace {

struct Parts {
  std::vector<u32> low, high, separator;
};

struct Dissection {
  const NodeGraph& graph;
  std::span<const Vec3> position;
  std::vector<u32> part, rank;  // of each node: the part that it is in now, its place there
  std::vector<u32> order;
  u32 n_parts = 0;

  template <class Found>
  void for_each_neighbour(u32 node, u32 in_part, const Found& found) const {
    for (u32 k = graph.first[node]; k < graph.first[node + 1]; ++k)
      if (part[graph.neighbour[k]] == in_part) found(graph.neighbour[k]);
  }

  void number(std::span<const u32> nodes) {
    for (u32 i = 0; i < nodes.size(); ++i) rank[nodes[i]] = i;
  }

  void append_small(std::span<const u32> nodes, u32 mark) {
    number(nodes);
    NodeGraph inside{{0}, {}};
    for (const u32 node : nodes) {
      for_each_neighbour(node, mark, [&](u32 other) { inside.neighbour.push_back(rank[other]); });
      inside.first.push_back(u32(inside.neighbour.size()));
    }
    for (const u32 i : minimum_degree_order(inside)) order.push_back(nodes[i]);
  }

  // The cut of these nodes, in the order they have, that leaves the fewest in the separator and the halves alike; it
  // lies in the middle third. Empty where that would leave a half empty. least: cost of the best cut so far; lowered.
  Parts cut(const std::vector<u32>& nodes, u32 mark, double& least) {
    const u32 n = u32(nodes.size());
    number(nodes);
    std::vector<u32> lowest(n), highest(n);
    std::iota(lowest.begin(), lowest.end(), 0u);
    std::iota(highest.begin(), highest.end(), 0u);
    for (u32 i = 0; i < n; ++i)
      for_each_neighbour(nodes[i], mark, [&](u32 other) {
        lowest[i] = std::min(lowest[i], rank[other]);
        highest[i] = std::max(highest[i], rank[other]);
      });
    // how many nodes before (from) a cut have neighbours from (before) it on, by differences along the cuts
    std::vector<int> below(n + 2, 0), above(n + 2, 0);
    for (u32 i = 0; i < n; ++i) ++below[i + 1], --below[highest[i] + 1], ++above[lowest[i] + 1], --above[i + 1];
    std::partial_sum(below.begin(), below.end(), below.begin());
    std::partial_sum(above.begin(), above.end(), above.begin());
    u32 best = 0;
    bool takes_below = false;
    for (u32 at = n / 3; at <= 2 * n / 3; ++at)
      for (const bool is_below : {true, false}) {
        const double separator = is_below ? below[at] : above[at];
        const double low = at - (is_below ? separator : 0), high = n - at - (is_below ? 0 : separator);
        const double cost = separator * (1 + std::abs(high - low) / n);
        if (low <= 0 || high <= 0 || cost >= least) continue;
        least = cost, best = at, takes_below = is_below;
      }
    Parts parts;
    for (u32 i = 0; best > 0 && i < n; ++i) {
      const bool is_low = i < best;
      const bool is_between = takes_below ? is_low && highest[i] >= best : !is_low && lowest[i] < best;
      (is_between ? parts.separator : is_low ? parts.low : parts.high).push_back(nodes[i]);
    }
    return parts;
  }

  void dissect(std::vector<u32> nodes) {
    const u32 mark = ++n_parts;
    for (const u32 node : nodes) part[node] = mark;
    Parts parts;
    double least = std::numeric_limits<double>::infinity();
    for (int axis = 0; axis < 3 && nodes.size() > SMALL_PART; ++axis) {
      const auto place = [&](u32 node) {
        const Vec3& x = position[node];
        return std::tuple(x[axis], x[(axis + 1) % 3], x[(axis + 2) % 3], node);
      };
      std::sort(nodes.begin(), nodes.end(), [&](u32 a, u32 b) { return place(a) < place(b); });
      if (Parts found = cut(nodes, mark, least); !found.low.empty()) parts = std::move(found);
    }
    if (parts.low.empty()) return append_small(nodes, mark);
    for (const u32 node : parts.separator) part[node] = CUT_OFF;
    dissect(std::move(parts.low));
    dissect(std::move(parts.high));
    order.insert(order.end(), parts.separator.begin(), parts.separator.end());
  }
};

}  // namespace

std::vector<u32> nested_dissection(const NodeGraph& graph, std::span<const Vec3> position) {
  const u32 n = graph.n_nodes();
  Dissection dissection{graph, position, std::vector<u32>(n, 0), std::vector<u32>(n, 0), {}};
  std::vector<u32> all(n);
  std::iota(all.begin(), all.end(), 0u);
  dissection.dissect(std::move(all));
  return dissection.order;
}

}  // namespace pvg
