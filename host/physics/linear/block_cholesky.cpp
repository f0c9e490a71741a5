#include "host/physics/linear/block_cholesky.hpp"

#include <algorithm>
#include <array>
#include <type_traits>

namespace pvg {
namespace {

int round_up(int n, int multiple) { return (n + multiple - 1) / multiple * multiple; }

// Whole cache lines, an odd number of them: a power of two would put all columns into the same few cache sets.
int column_stride(int n_rows, int in_line) {
  const int lines = round_up(n_rows, in_line) / in_line;
  return in_line * (lines | 1);
}

// Double precision keeps its subnormal numbers.
struct Nothing {
  Nothing() {}
};
template <class Real>
using Subnormals = std::conditional_t<std::is_same_v<Real, float>, SubnormalsAreZero, Nothing>;

// of a number on the diagonal, that its pivot must be above
template <class Real>
constexpr Real LEAST_PIVOT = 0;
template <>
constexpr float LEAST_PIVOT<float> = 1e-4f;

// Blocks of a front lie anywhere in the matrix; how many the memory is asked for before their turn.
constexpr std::size_t BLOCKS_AHEAD = 8;

}  // namespace

template <class Real>
BlockCholesky<Real>::BlockCholesky(const BlockPattern& pattern, std::span<const Vec3> position,
                                   std::optional<NodeOrder> order)
    : BlockCholesky(pattern, eliminate(pattern, position, order)) {}

template <class Real>
BlockCholesky<Real>::BlockCholesky(const BlockPattern& pattern, EliminationTree tree)
    : tree_(std::move(tree)), fronts_(tree_.supernodes.size()) {
  lay_out_panels();
  choose_subtrees();
  lay_out_updates();
  map_to_parents();
  map_entries(pattern);
}

template <class Real>
void BlockCholesky<Real>::lay_out_panels() {
  std::size_t n_panel = 0, n_x = 0, n_pivots = 0;
  for (const bool has_memory : {false, true}) {
    if (has_memory) {
      n_panel_lines_ = n_panel / IN_LINE;
      panels_ = std::make_unique_for_overwrite<CacheLine[]>(n_panel_lines_);
      x_.resize(n_x / IN_LINE);
      least_.resize(n_pivots);
    }
    n_panel = n_x = n_pivots = 0;
    for (std::size_t s = 0; s < fronts_.size(); ++s) {
      Panel<Real>& panel = fronts_[s].panel;
      panel.n_pivots = 3 * int(tree_.supernodes[s].n_pivots);
      panel.first_row = round_up(panel.n_pivots, 4);
      panel.n_rows = 3 * int(tree_.supernodes[s].rows.size());
      panel.last_row = panel.first_row + round_up(panel.n_rows, 4);
      panel.stride = column_stride(panel.last_row, IN_LINE);
      if (has_memory) {
        // counted over all lines, which follow each other without gaps
        panel.values = reinterpret_cast<Real*>(panels_.get()) + n_panel;
        fronts_[s].x = reinterpret_cast<Real*>(x_.data()) + n_x;
        fronts_[s].least = least_.data() + n_pivots;
      }
      n_panel += std::size_t(panel.stride) * panel.n_pivots;
      n_x += panel.stride;
      n_pivots += panel.n_pivots;
    }
  }
}

// Cuts the costliest subtree at its root as long as that shortens the time two threads would take.
template <class Real>
void BlockCholesky<Real>::choose_subtrees() {
  const u32 n = u32(fronts_.size());
  std::vector<double> cost(n);
  std::vector<u32> first(n);
  std::vector<Subtree> subtrees;
  for (u32 s = 0; s < n; ++s) {
    const Supernode& node = tree_.supernodes[s];
    cost[s] = node.cost;
    first[s] = node.children.empty() ? s : first[node.children[0]];
    for (const u32 child : node.children) cost[s] += cost[child];
    if (node.parent == NO_PARENT) subtrees.push_back({first[s], s + 1, cost[s]});
  }
  const auto is_costlier = [](const Subtree& a, const Subtree& b) { return a.cost > b.cost; };
  std::vector<u32> top;
  double top_cost = 0, least_time = tree_.cost;
  subtrees_ = subtrees;
  for (int cut = 0; cut < 64 && !subtrees.empty(); ++cut) {
    std::stable_sort(subtrees.begin(), subtrees.end(), is_costlier);
    std::array<double, 2> busy{};
    for (const Subtree& subtree : subtrees) *std::min_element(busy.begin(), busy.end()) += subtree.cost;
    const double time = top_cost + std::max(busy[0], busy[1]);
    if (time < least_time) least_time = time, subtrees_ = subtrees, top_ = top;
    const u32 root = subtrees[0].last - 1;
    subtrees.erase(subtrees.begin());
    top.push_back(root);
    top_cost += tree_.supernodes[root].cost;
    for (const u32 child : tree_.supernodes[root].children) subtrees.push_back({first[child], child + 1, cost[child]});
  }
  std::sort(top_.begin(), top_.end());
  has_failed_.resize(subtrees_.size());
}

// An update lives from its front to the parent's. Within a subtree those of even and of odd depth form two stacks: a
// front pops its children's from one and pushes its own on the other. The update of a subtree's root has its own place.
template <class Real>
void BlockCholesky<Real>::lay_out_updates() {
  std::vector<std::size_t> offset(fronts_.size(), 0);
  std::vector<u32> depth(fronts_.size(), 0);
  for (u32 s = u32(fronts_.size()); s-- > 0;)
    if (tree_.supernodes[s].parent != NO_PARENT) depth[s] = depth[tree_.supernodes[s].parent] + 1;
  const auto size = [&](u32 s) { return std::size_t(fronts_[s].update_stride) * fronts_[s].panel.n_rows; };
  for (Front& front : fronts_)
    front.update_stride = front.panel.n_rows > 0 ? column_stride(front.panel.n_rows, IN_LINE) : 0;
  std::vector<char> is_in_stack(fronts_.size(), false);
  std::size_t n_numbers = 0;
  const auto lay_out = [&](const std::vector<u32>& fronts) {
    std::array<std::size_t, 2> height{}, highest{};
    for (const u32 s : fronts) {
      for (const u32 child : tree_.supernodes[s].children)
        if (is_in_stack[child]) height[depth[child] % 2] -= size(child);
      offset[s] = height[depth[s] % 2];
      height[depth[s] % 2] += size(s);
      is_in_stack[s] = true;
      highest[depth[s] % 2] = std::max(highest[depth[s] % 2], height[depth[s] % 2]);
    }
    for (const u32 s : fronts) offset[s] += n_numbers + (depth[s] % 2 ? highest[0] : 0);
    n_numbers += highest[0] + highest[1];
    if (fronts.empty()) return;
    is_in_stack[fronts.back()] = false;
    offset[fronts.back()] = n_numbers;
    n_numbers += size(fronts.back());
  };
  for (const Subtree& subtree : subtrees_) {
    std::vector<u32> fronts;
    for (u32 s = subtree.first; s < subtree.last; ++s) fronts.push_back(s);
    lay_out(fronts);
  }
  lay_out(top_);
  updates_ = std::make_unique_for_overwrite<CacheLine[]>(n_numbers / IN_LINE);
  for (u32 s = 0; s < fronts_.size(); ++s)
    if (size(s) > 0) fronts_[s].update = reinterpret_cast<Real*>(updates_.get()) + offset[s];
}

template <class Real>
void BlockCholesky<Real>::map_to_parents() {
  for (u32 s = 0; s < fronts_.size(); ++s) {
    const Supernode& node = tree_.supernodes[s];
    if (node.parent == NO_PARENT) continue;
    const Supernode& parent = tree_.supernodes[node.parent];
    const int first_row = fronts_[node.parent].panel.first_row;
    std::vector<Run>& runs = fronts_[s].to_parent;
    for (u32 i = 0; i < node.rows.size(); ++i) {
      const u32 row = node.rows[i];
      const auto found = std::lower_bound(parent.rows.begin(), parent.rows.end(), row);
      const int to = row < parent.first + parent.n_pivots ? 3 * int(row - parent.first)
                                                          : first_row + 3 * int(found - parent.rows.begin());
      // a run ends where the parent's pivots end, even if nothing lies between
      if (!runs.empty() && runs.back().to + runs.back().n == to && to != first_row)
        runs.back().n += 3;
      else
        runs.push_back({3 * int(i), to, 3});
    }
  }
}

template <class Real>
void BlockCholesky<Real>::map_entries(const BlockPattern& pattern) {
  std::vector<u32> owner(pattern.n_nodes());
  for (u32 s = 0; s < fronts_.size(); ++s)
    for (u32 k = 0; k < tree_.supernodes[s].n_pivots; ++k) owner[tree_.supernodes[s].first + k] = s;
  for (u32 c = 0; c < pattern.n_nodes(); ++c)
    for (u32 k = pattern.column_first[c]; k < pattern.column_first[c + 1]; ++k) {
      const u32 a = tree_.position[pattern.row[k]], b = tree_.position[c], column = std::min(a, b),
                row = std::max(a, b);
      const Supernode& node = tree_.supernodes[owner[column]];
      Front& front = fronts_[owner[column]];
      const auto found = std::lower_bound(node.rows.begin(), node.rows.end(), row);
      const int panel_row = row < node.first + node.n_pivots
                                ? 3 * int(row - node.first)
                                : front.panel.first_row + 3 * int(found - node.rows.begin());
      front.entries.push_back({k, panel_row + 3 * int(column - node.first) * front.panel.stride, a < b});
    }
}

template <class Real>
void BlockCholesky<Real>::assemble(const Front& front, std::span<const double* const> blocks) {
  const int stride = front.panel.stride;
  std::fill_n(front.panel.values, std::size_t(stride) * front.panel.n_pivots, Real(0));
  for (std::size_t i = 0; i < front.entries.size(); ++i) {
    const double* ahead = blocks[front.entries[std::min(i + BLOCKS_AHEAD, front.entries.size() - 1)].block];
    __builtin_prefetch(ahead), __builtin_prefetch(ahead + 8);
    const Entry& entry = front.entries[i];
    const double* from = blocks[entry.block];
    Real* to = front.panel.values + entry.first;
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 3; ++c) to[r + c * stride] = Real(entry.is_transposed ? from[3 * c + r] : from[3 * r + c]);
  }
  for (int k = 0; k < front.panel.n_pivots; ++k)
    front.least[k] = LEAST_PIVOT<Real> * front.panel.values[k + k * stride];
}

template <class Real>
void BlockCholesky<Real>::add_update(const Front& child, const Front& parent, Part part) {
  const Panel<Real>& panel = parent.panel;
  for (std::size_t k = 0; k < child.to_parent.size(); ++k) {
    const Run& columns = child.to_parent[k];
    if ((columns.to < panel.n_pivots) != (part == Part::PIVOTS)) continue;
    for (int c = 0; c < columns.n; ++c) {
      const int column = columns.to + c;
      const Real* from = child.update + (columns.from + c) * child.update_stride;
      Real* to = part == Part::PIVOTS
                     ? panel.values + column * panel.stride
                     : parent.update + (column - panel.first_row) * parent.update_stride - panel.first_row;
      const Run diagonal{columns.from + c, column, columns.n - c};
      add_runs(to, from, &diagonal, 1);
      add_runs(to, from, &columns + 1, child.to_parent.size() - k - 1);
    }
  }
}

template <class Real>
bool BlockCholesky<Real>::factor(u32 s, std::span<const double* const> blocks) const {
  const Front& front = fronts_[s];
  const std::vector<u32>& children = tree_.supernodes[s].children;
  assemble(front, blocks);
  for (const u32 child : children) add_update(fronts_[child], front, Part::PIVOTS);
  if (!factor_panel(front.panel, front.least)) return false;
  if (front.panel.n_rows == 0) return true;
  // product first, so that nothing need be cleared
  set_negative_outer_product(front.panel, front.update, front.update_stride);
  for (const u32 child : children) add_update(fronts_[child], front, Part::REST);
  return true;
}

template <class Real>
template <class Task>
void BlockCholesky<Real>::for_each_subtree(Workers* workers, double least_cost, const Task& task) const {
  if (workers != nullptr && workers->n_threads() > 1 && subtrees_.size() > 1 && tree_.cost >= least_cost)
    return workers->run(subtrees_.size(), [&](std::size_t i) {
      const Subnormals<Real> here;
      task(i);
    });
  for (std::size_t i = 0; i < subtrees_.size(); ++i) task(i);
}

template <class Real>
bool BlockCholesky<Real>::factorize(std::span<const double> blocks, Workers* workers) {
  std::vector<const double*> each;
  for (std::size_t first = 0; first < blocks.size(); first += 9) each.push_back(&blocks[first]);
  return factorize(each, workers);
}

template <class Real>
bool BlockCholesky<Real>::factorize(std::span<const double* const> blocks, Workers* workers) {
  const Subnormals<Real> here;
  // below about a tenth of a millisecond waking a thread takes longer
  for_each_subtree(workers, 1e6, [&](std::size_t i) {
    has_failed_[i] = false;
    for (u32 s = subtrees_[i].first; s < subtrees_[i].last && !has_failed_[i]; ++s) has_failed_[i] = !factor(s, blocks);
  });
  if (std::find(has_failed_.begin(), has_failed_.end(), true) != has_failed_.end()) return false;
  return std::all_of(top_.begin(), top_.end(), [&](u32 s) { return factor(s, blocks); });
}

template <class Real>
void BlockCholesky<Real>::forward(u32 s, std::span<const double> x) const {
  const Front& front = fronts_[s];
  const Supernode& node = tree_.supernodes[s];
  for (u32 k = 0; k < node.n_pivots; ++k)
    for (int i = 0; i < 3; ++i) front.x[3 * k + i] = Real(x[3 * std::size_t(tree_.order[node.first + k]) + i]);
  std::fill(front.x + front.panel.n_pivots, front.x + front.panel.stride, Real(0));
  for (const u32 c : node.children) {
    const Front& child = fronts_[c];
    add_runs(front.x, child.x + child.panel.first_row, child.to_parent.data(), child.to_parent.size());
  }
  solve_forward(front.panel, front.x);
}

template <class Real>
void BlockCholesky<Real>::backward(u32 s, std::span<double> x) const {
  const Front& front = fronts_[s];
  const Supernode& node = tree_.supernodes[s];
  for (const Run& run : front.to_parent)
    std::copy_n(fronts_[node.parent].x + run.to, run.n, front.x + front.panel.first_row + run.from);
  solve_backward(front.panel, front.x);
  for (u32 k = 0; k < node.n_pivots; ++k)
    std::copy_n(front.x + 3 * k, 3, &x[3 * std::size_t(tree_.order[node.first + k])]);
}

template <class Real>
void BlockCholesky<Real>::solve(std::span<double> x, Workers* workers) const {
  const Subnormals<Real> here;
  const double least_cost = 3e7;
  for_each_subtree(workers, least_cost, [&](std::size_t i) {
    for (u32 s = subtrees_[i].first; s < subtrees_[i].last; ++s) forward(s, x);
  });
  for (const u32 s : top_) forward(s, x);
  for (std::size_t i = top_.size(); i-- > 0;) backward(top_[i], x);
  for_each_subtree(workers, least_cost, [&](std::size_t i) {
    for (u32 s = subtrees_[i].last; s-- > subtrees_[i].first;) backward(s, x);
  });
}

template class BlockCholesky<double>;
template class BlockCholesky<float>;

}  // namespace pvg
