#include "host/physics/linear/group_preconditioner.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <numeric>

namespace pvg {
namespace {

constexpr double WORTH_A_THREAD = 3e5;  // operations; to wake one takes as long
// Operations above which single precision saves more than the iterations of conjugate gradients that it adds; by
// measurement between 3e6 and 7e7 (docs/measured/2026-11-27_single_precision_factor.md).
constexpr double WORTH_SINGLE = 2e7;
constexpr double OF_A_CONTACT = 2e3;  // operations, about, to add one

// to += weight x the 3 x 3 block of a row-major element block
void add(double* to, const double* from, std::size_t width, double weight) {
  for (std::size_t r = 0; r < 3; ++r)
    for (std::size_t c = 0; c < 3; ++c) to[3 * r + c] += weight * from[r * width + c];
}

bool is_zero(const double* block, std::size_t width) {
  for (std::size_t r = 0; r < 3; ++r)
    for (std::size_t c = 0; c < 3; ++c)
      if (block[r * width + c] != 0) return false;
  return true;
}

}  // namespace

// Calls found(row node, column node, 3 x 3 block of the element's, weight) for every pair of nodes of one element that
// lie in one group with row >= column. block: of an element, [3 stencil x 3 stencil]; what is zero is left out, as
// where a contact has fewer sites than its stencil
template <class Found>
void GroupPreconditioner::for_each_block(std::span<const u32> element_sites, std::span<const double> block,
                                         const Found& found) const {
  const std::size_t stencil = element_sites.size(), width = 3 * stencil;
  for (std::size_t a = 0; a < stencil; ++a)
    for (std::size_t b = 0; b < stencil; ++b) {
      const double* from = &block[3 * a * width + 3 * b];
      if (is_zero(from, width)) continue;
      const Site &row_site = sites_[element_sites[a]], &column_site = sites_[element_sites[b]];
      for (int i = 0; i < 4; ++i)
        for (int j = 0; j < 4; ++j) {
          const double weight = row_site.weight[i] * column_site.weight[j];
          if (weight == 0) continue;
          const u32 row = row_site.node[i], column = column_site.node[j];
          if (node_group_[row] == NO_GROUP || node_group_[row] != node_group_[column]) continue;
          if (node_local_[row] >= node_local_[column]) found(row, column, from, weight);
        }
    }
}

GroupPreconditioner::GroupPreconditioner(const MatrixPattern& matrix, std::span<const Site> sites,
                                         std::span<const double> position, std::span<const u32> node_group,
                                         std::span<const u32> group_world, std::span<const NodePair> coupled,
                                         Device* factors_on, std::size_t n_threads)
    : matrix_(matrix),
      sites_(sites.begin(), sites.end()),
      position_(position.begin(), position.end()),
      lone_group_(node_group.begin(), node_group.end()),
      group_world_(group_world.begin(), group_world.end()),
      lone_nodes_(group_world.size()),
      always_coupled_(coupled.begin(), coupled.end()),
      node_group_(node_group.begin(), node_group.end()),
      node_local_(node_group.size(), 0),
      workers_(std::make_unique<Workers>(n_threads)),
      device_factor_(factors_on ? std::make_unique<DeviceFactor>(*factors_on, node_group.size()) : nullptr) {
  for (u32 node = 0; node < lone_group_.size(); ++node)
    if (lone_group_[node] != NO_GROUP) lone_nodes_[lone_group_[node]].push_back(node);
  lone_order_.resize(group_world.size());
  lone_cost_.resize(group_world.size());
  couple({});
  for (const Group& group : groups_)
    for (const u32 lone : group.joined) {
      lone_order_[lone] = group.kind;
      lone_cost_[lone] = group.cost;
    }
}

double GroupPreconditioner::world_cost(u32 world) const {
  double sum = 0;
  for (std::size_t group = 0; group < lone_cost_.size(); ++group)
    if (group_world_[group] == world) sum += lone_cost_[group];
  return sum;
}

// That of its largest part: a few contacts do not change which one suits.
std::optional<NodeOrder> GroupPreconditioner::order_of(const Group& group) const {
  return lone_order_[*std::max_element(group.joined.begin(), group.joined.end(),
                                       [&](u32 a, u32 b) { return lone_nodes_[a].size() < lone_nodes_[b].size(); })];
}

// The sets of groups that pairs hold together, ascending, in the order of their first.
std::vector<std::vector<u32>> GroupPreconditioner::join(std::span<const NodePair> pairs) const {
  std::vector<u32> root(group_world_.size());
  std::iota(root.begin(), root.end(), 0u);
  const auto find = [&](u32 group) {
    while (root[group] != group) group = root[group] = root[root[group]];
    return group;
  };
  for (const auto& [a, b] : pairs) {
    const u32 first = find(lone_group_[a]), second = find(lone_group_[b]);
    root[std::max(first, second)] = std::min(first, second);
  }
  std::vector<std::vector<u32>> sets;
  std::vector<u32> set_of(root.size());
  for (u32 group = 0; group < root.size(); ++group) {
    const u32 first = find(group);
    if (first == group) {
      set_of[group] = u32(sets.size());
      sets.emplace_back();
    }
    sets[set_of[first]].push_back(group);
  }
  return sets;
}

void GroupPreconditioner::couple(std::span<const NodePair> pairs) {
  std::vector<NodePair> all(pairs.begin(), pairs.end());
  all.insert(all.end(), always_coupled_.begin(), always_coupled_.end());
  for (NodePair& pair : all) std::sort(pair.begin(), pair.end());
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());

  std::vector<Group> now;
  for (std::vector<u32>& joined : join(all)) {
    Group& group = now.emplace_back();
    group.world = group_world_[joined.front()];
    for (const u32 lone : joined)
      for (const u32 node : lone_nodes_[lone]) node_group_[node] = u32(now.size() - 1);
    group.joined = std::move(joined);
  }
  for (const NodePair& pair : all) now[node_group_[pair[0]]].pairs.push_back(pair);

  std::map<std::vector<u32>, Group*> before;
  for (Group& group : groups_) before[group.joined] = &group;
  for (Group& group : now)
    if (const auto found = before.find(group.joined); found != before.end() && found->second->pairs == group.pairs)
      group = std::move(*found->second);
  groups_ = std::move(now);
  for (Group& group : groups_) {
    if (group.nodes.empty()) {
      for (const u32 lone : group.joined)
        group.nodes.insert(group.nodes.end(), lone_nodes_[lone].begin(), lone_nodes_[lone].end());
      std::sort(group.nodes.begin(), group.nodes.end());
    }
    for (u32 i = 0; i < group.nodes.size(); ++i) node_local_[group.nodes[i]] = i;
  }
  std::vector<u32> changed;
  for (u32 g = 0; g < groups_.size(); ++g)
    if (groups_[g].pattern.n_nodes() == 0) changed.push_back(g);
  workers_->run(changed.size(), [&](std::size_t i) { find_pattern(groups_[changed[i]]); });
  if (device_factor_ && !changed.empty()) give_to_device();
}

void GroupPreconditioner::give_to_device() {
  std::vector<FactorGroup> groups;
  for (const Group& group : groups_)
    groups.push_back({&group.tree, &group.pattern, group.nodes, group.source, group.world});
  device_factor_->set(groups);
}

void GroupPreconditioner::find_pattern(Group& group) const {
  std::vector<std::vector<u32>> coupled_rows(group.nodes.size());  // of each column
  for (const auto& [a, b] : group.pairs) coupled_rows[node_local_[a]].push_back(b);
  const u32 g = node_group_[group.nodes.front()];
  std::vector<u32> rows;  // of one column, global
  group.pattern.column_first.push_back(0);
  for (const u32 column : group.nodes) {
    // the matrix is symmetric: rows of its column stand in its row
    rows.assign(1, column);
    for (u32 k = matrix_.first[column]; k < matrix_.first[column + 1]; ++k) rows.push_back(matrix_.column[k]);
    const std::vector<u32>& coupled = coupled_rows[node_local_[column]];
    rows.insert(rows.end(), coupled.begin(), coupled.end());
    std::sort(rows.begin(), rows.end());
    rows.erase(std::unique(rows.begin(), rows.end()), rows.end());
    for (const u32 row : rows) {
      if (row < column || node_group_[row] != g) continue;
      group.pattern.row.push_back(node_local_[row]);
      group.source.push_back(matrix_.find(row, column));
    }
    group.pattern.column_first.push_back(u32(group.pattern.row.size()));
  }
  std::vector<Vec3> position;
  for (const u32 node : group.nodes) position.emplace_back(&position_[3 * std::size_t(node)]);
  EliminationTree tree = eliminate(group.pattern, position, order_of(group));
  group.cost = tree.cost;
  group.kind = tree.kind;
  if (device_factor_) {
    group.tree = std::move(tree);
    return;
  }
  group.block_at.resize(group.pattern.row.size());
  group.blocks.resize(9 * group.pattern.row.size());
  group.local.resize(3 * group.nodes.size());
  if (tree.cost >= WORTH_SINGLE)
    group.single_factor = std::make_unique<BlockCholesky<float>>(group.pattern, std::move(tree));
  else
    group.factor = std::make_unique<BlockCholesky<double>>(group.pattern, std::move(tree));
}

std::size_t GroupPreconditioner::n_bytes() const {
  if (device_factor_) return sizeof(double) * device_factor_->n_numbers();
  std::size_t n = 0;
  for (const Group& group : groups_)
    n += (group.factor ? group.factor->n_bytes() : 0) + (group.single_factor ? group.single_factor->n_bytes() : 0);
  return n;
}

// NO_BLOCK where no element couples the two local nodes
u32 GroupPreconditioner::find_block(const Group& group, u32 row, u32 column) {
  const auto first = group.pattern.row.begin() + group.pattern.column_first[column];
  const auto last = group.pattern.row.begin() + group.pattern.column_first[column + 1];
  const auto found = std::lower_bound(first, last, row);
  return found != last && *found == row ? u32(found - group.pattern.row.begin()) : NO_BLOCK;
}

// The contacts of one world touch that world's groups only, so worlds go side by side.
void GroupPreconditioner::add_contacts(const Term& contacts, std::span<const double> blocks) {
  const std::size_t stencil = contacts.stencil(), width = 3 * stencil;
  const std::span<const u32> sites = contacts.sites();
  const auto add_contact = [&](std::size_t e) {
    for_each_block(sites.subspan(e * stencil, stencil), blocks.subspan(e * width * width, width * width),
                   [&](u32 row, u32 column, const double* from, double weight) {
                     Group& group = groups_[node_group_[row]];
                     if (!group.is_renewed) return;
                     const u32 block = find_block(group, node_local_[row], node_local_[column]);
                     if (block != NO_BLOCK)
                       add(own_block(group, block), from, width, weight);
                     else
                       leave_out(group, node_local_[row], node_local_[column], from, width, std::abs(weight));
                   });
  };
  const std::vector<u32>& first = contacts.world_first();
  if (first.empty()) return;
  const auto add_world = [&](std::size_t world) {
    for (std::size_t e = first[world]; e < first[world + 1]; ++e) add_contact(e);
  };
  if (OF_A_CONTACT * first.back() > WORTH_A_THREAD)
    workers_->run(first.size() - 1, add_world);
  else
    for (std::size_t world = 0; world + 1 < first.size(); ++world) add_world(world);
}

// Contact may couple nodes that nothing else couples. Such a block C is left to conjugate gradients; without it the
// matrix might be indefinite, so its size goes to both diagonals: |C| (x^2 + y^2) - 2 x C y >= 0.
void GroupPreconditioner::leave_out(Group& group, u32 row, u32 column, const double* from, std::size_t width,
                                    double weight) {
  double square = 0;
  for (std::size_t r = 0; r < 3; ++r)
    for (std::size_t c = 0; c < 3; ++c) square += from[r * width + c] * from[r * width + c];
  for (const u32 node : {row, column})
    for (int k = 0; k < 3; ++k) own_block(group, find_block(group, node, node))[4 * k] += weight * std::sqrt(square);
}

// Groups that are more than one thread's share use all threads themselves, one after the other; the others run side by
// side.
template <class Task>
void GroupPreconditioner::for_each_group(bool Group::*is_in, const Task& task) const {
  double total = 0;
  for (const Group& group : groups_)
    if (group.*is_in) total += group.cost;
  if (total < WORTH_A_THREAD) {
    for (u32 g = 0; g < groups_.size(); ++g)
      if (groups_[g].*is_in) task(g, nullptr);
    return;
  }
  std::vector<u32> small;
  for (u32 g = 0; g < groups_.size(); ++g) {
    if (!(groups_[g].*is_in)) continue;
    if (groups_[g].cost * double(workers_->n_threads()) > total)
      task(g, workers_.get());
    else
      small.push_back(g);
  }
  workers_->run(small.size(), [&](std::size_t i) { task(small[i], nullptr); });
}

void GroupPreconditioner::take_blocks(std::span<const double> values) {
  for_each_group(&Group::is_renewed, [&](u32 g, Workers*) {
    Group& group = groups_[g];
    static constexpr double ZERO[9] = {};
    for (std::size_t block = 0; block < group.source.size(); ++block)
      group.block_at[block] = group.source[block] == NO_BLOCK ? ZERO : &values[9 * std::size_t(group.source[block])];
  });
}

// A copy of a block, to be added to.
double* GroupPreconditioner::own_block(Group& group, u32 block) {
  double* own = &group.blocks[9 * std::size_t(block)];
  if (group.block_at[block] != own) std::copy_n(group.block_at[block], 9, own);
  group.block_at[block] = own;
  return own;
}

bool GroupPreconditioner::factor(Group& group, Workers* workers) {
  group.is_single = group.single_factor && group.single_factor->factorize(group.block_at, workers);
  if (group.is_single) return true;
  if (!group.factor) group.factor = std::make_unique<BlockCholesky<double>>(group.pattern, group.single_factor->tree());
  return group.factor->factorize(group.block_at, workers);
}

void GroupPreconditioner::start_factorize(const Buffer<f64>& blocks, const ContactElements& contacts,
                                          std::span<const char> world_is_active, const Buffer<f64>* gradient,
                                          std::span<const char> world_keeps) {
  if (device_factor_) return device_factor_->start_factorize(blocks, contacts, world_is_active, gradient);
  std::vector<detail::HostAccess> access = {reads(blocks)};
  for (const Term* term : contacts.terms) access.push_back(reads(term->blocks()));
  blocks.memory().device().call(
      std::move(access), [this, n = blocks.size(), terms = std::vector(contacts.terms.begin(), contacts.terms.end()),
                          active = std::vector(world_is_active.begin(), world_is_active.end()),
                          keeps = std::vector(world_keeps.begin(), world_keeps.end())](std::span<void* const> memory) {
        const auto numbers = [&](std::size_t i, std::size_t size) {
          return std::span(static_cast<const double*>(memory[i]), size);
        };
        for (Group& group : groups_) {
          group.is_active = active[group.world];
          group.is_renewed = group.is_active && (keeps.empty() || !keeps[group.world]);
        }
        const auto is_renewed = [](const Group& group) { return group.is_renewed; };
        if (std::none_of(groups_.begin(), groups_.end(), is_renewed)) return;
        take_blocks(numbers(0, n));
        for (std::size_t i = 0; i < terms.size(); ++i)
          add_contacts(*terms[i], numbers(i + 1, terms[i]->blocks().size()));
        for_each_group(&Group::is_renewed,
                       [&](u32 g, Workers* workers) { groups_[g].is_factored = factor(groups_[g], workers); });
      });
}

std::optional<u32> GroupPreconditioner::failed() const {
  if (device_factor_) {
    const auto group = device_factor_->failed();
    return group ? std::optional(groups_[*group].nodes.front()) : std::nullopt;
  }
  for (const Group& group : groups_)
    if (group.is_active && !group.is_factored) return group.nodes.front();
  return std::nullopt;
}

std::optional<u32> GroupPreconditioner::factorize(const Buffer<f64>& blocks, const ContactElements& contacts,
                                                  std::span<const char> world_is_active) {
  start_factorize(blocks, contacts, world_is_active);
  blocks.memory().device().finish();
  return failed();
}

void GroupPreconditioner::start_apply(const Buffer<f64>& residual, bool adds, Buffer<f64>& preconditioned) const {
  if (device_factor_) return device_factor_->start_apply(residual, adds, preconditioned);
  detail::HostAccess result = writes(preconditioned);
  result.is_read = adds;
  residual.memory().device().call({reads(residual), result},
                                  [this, adds, n = residual.size()](std::span<void* const> memory) {
                                    const std::span r(static_cast<const double*>(memory[0]), n);
                                    const std::span z(static_cast<double*>(memory[1]), n);
                                    if (!adds) return apply(r, z);
                                    std::vector<double> own(n);
                                    apply(r, own);
                                    std::transform(own.begin(), own.end(), z.begin(), z.begin(), std::plus<>());
                                  });
}

void GroupPreconditioner::apply(std::span<const double> residual, std::span<double> preconditioned) const {
  std::fill(preconditioned.begin(), preconditioned.end(), 0.0);
  for_each_group(&Group::is_active, [&](u32 g, Workers* workers) {
    const Group& group = groups_[g];
    if (!group.is_factored) return;
    for (std::size_t i = 0; i < group.nodes.size(); ++i)
      std::copy_n(&residual[3 * std::size_t(group.nodes[i])], 3, &group.local[3 * i]);
    if (group.is_single)
      group.single_factor->solve(group.local, workers);
    else
      group.factor->solve(group.local, workers);
    for (std::size_t i = 0; i < group.nodes.size(); ++i)
      std::copy_n(&group.local[3 * i], 3, &preconditioned[3 * std::size_t(group.nodes[i])]);
  });
}

}  // namespace pvg
