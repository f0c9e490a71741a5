#include "host/physics/linear/device_factor.hpp"

#include <algorithm>
#include <limits>
#include <utility>

namespace pvg {
namespace {

constexpr u32 IS_TRANSPOSED = 1u << 31;   // as in solve/factor_blocks.cl
constexpr u32 FORWARD = 1, BACKWARD = 2;  // as in solve/factor_solve.cl
constexpr u32 PLACE_SHARES = 16;          // work-items for each block that is placed, as in solve/factor_blocks.cl
constexpr std::size_t MOST_NUMBERS = 1u << 31;  // a place has 32 bits

// Estimates for a work-group of FACTOR_ITEMS on a large GPU, near what an H100 took: what a launch, a barrier with the
// memory behind it, and a number take. They decide how the tree is divided, not what is computed.
constexpr unsigned N_UNITS = 100;                                                    // work-groups at a time
constexpr double LAUNCH = 7e-6, BARRIER = 1e-6, PRODUCT = 1 / 16e9, LOAD = 1 / 8e9;  // [s]

double barriers(const FactorFront& front) { return double(front.n_pivots + FACTOR_WIDTH - 1) / FACTOR_WIDTH; }

double seconds_to_factor(const FactorFront& front) {
  const double p = front.n_pivots, r = front.n_rows;
  return BARRIER * (3 + 4 * barriers(front)) + PRODUCT * (p * p * p / 6 + p * p * r / 2 + p * r * r / 2) + LOAD * r * r;
}

double seconds_to_solve(const FactorFront& front) {
  const double p = front.n_pivots, r = front.n_rows;
  return BARRIER * (3 + 2 * barriers(front)) + LOAD * (p * p / 2 + p * r);
}

template <class T>
void upload(Buffer<T>& buffer, const std::vector<T>& values) {
  buffer.resize(values.size());
  buffer.write(values);
}

}  // namespace

DeviceFactor::Tasks::Tasks(Device& device, const char* name)
    : first(device, 0, std::string("first front of ") + name), front(device, 0, std::string("fronts of ") + name) {}

void DeviceFactor::Tasks::set(const FactorSchedule& schedule) {
  stage_first = schedule.stage_first;
  n_stages = schedule.n_stages();
  upload(first, schedule.task_first);
  upload(front, schedule.front);
}

DeviceFactor::DeviceFactor(Device& device, std::size_t n_nodes)
    : n_nodes_(n_nodes),
      blocks_program_(device, "solve/factor_blocks.cl"),
      fronts_program_(device, "solve/factor_fronts.cl"),
      solve_program_(device, "solve/factor_solve.cl"),
      place_blocks_(blocks_program_.kernel("factor_place_blocks")),
      factor_fronts_(fronts_program_.kernel("factor_fronts")),
      factor_solve_(solve_program_.kernel("factor_solve")),
      factoring_(device, "factoring"),
      solving_(device, "solving"),
      fronts_(device, 0, "fronts"),
      children_(device, 0, "children"),
      places_(device, 0, "places"),
      front_nodes_(device, 0, "nodes of fronts"),
      lone_nodes_(device, 0, "lone nodes"),
      row_(device, 0, "row of block"),
      column_(device, 0, "column of block"),
      source_(device, 0, "source of block"),
      place_(device, 0, "place of block"),
      stride_(device, 0, "stride of block"),
      hole_place_(device, 0, "place of hole"),
      hole_stride_(device, 0, "stride of hole"),
      block_first_(device, n_nodes, "first block of column"),
      block_last_(device, n_nodes, "last block of column"),
      node_group_(device, n_nodes, "group of node"),
      group_is_active_(device, 0, "group is active"),
      failed_(device, 0, "failed groups"),
      panels_(device, 0, "panels of the factor"),
      updates_(device, 0, "updates of the factor"),
      vectors_(device, 0, "vectors of fronts"),
      no_indices_(device, 0, "no indices"),
      no_sites_(device, 0, "no sites"),
      no_numbers_(device, 0, "no numbers") {}

void DeviceFactor::set(std::span<const FactorGroup> groups) {
  group_world_.clear();
  for (const FactorGroup& group : groups) group_world_.push_back(group.world);
  written_active_.clear();
  host_failed_.assign(groups.size(), 0);
  group_is_active_.resize(groups.size());
  failed_.resize(groups.size());
  lay_out(groups);
  list_blocks(groups);
  std::vector<u32> parent;
  std::vector<double> factoring, solving;
  for (const FactorFront& front : host_fronts_) {
    parent.push_back(front.parent);
    factoring.push_back(seconds_to_factor(front));
    solving.push_back(seconds_to_solve(front));
  }
  factoring_.set(make_schedule(parent, factoring, LAUNCH, N_UNITS));
  solving_.set(make_schedule(parent, solving, LAUNCH, N_UNITS));
}

// Where each front's numbers stand, and how it hangs together with its parent.
void DeviceFactor::lay_out(std::span<const FactorGroup> groups) {
  host_fronts_.clear(), host_nodes_.clear(), order_.clear();
  group_front_ = {0};
  std::vector<u32> children, places;
  std::size_t n_panel = 0, n_update = 0, n_vector = 0;
  for (u32 g = 0; g < groups.size(); ++g) {
    const EliminationTree& tree = *groups[g].tree;
    const u32 first_front = group_front_.back();
    const auto global = [&](u32 position) { return groups[g].nodes[tree.order[position]]; };
    for (const Supernode& node : tree.supernodes) {
      FactorFront& front = host_fronts_.emplace_back();
      front = {3 * node.n_pivots,
               3 * u32(node.rows.size()),
               u32(n_panel),
               u32(n_update),
               u32(n_vector),
               u32(host_nodes_.size()),
               u32(places.size()),
               u32(children.size()),
               0,
               node.parent == NO_PARENT ? NO_PARENT : first_front + node.parent,
               g,
               0};
      for (const u32 child : node.children) children.push_back(first_front + child);
      front.last_child = u32(children.size());
      for (u32 k = 0; k < node.n_pivots; ++k) host_nodes_.push_back(global(node.first + k));
      for (const u32 row : node.rows) host_nodes_.push_back(global(row));
      const std::size_t n = front.n_pivots + front.n_rows;
      n_panel += n * front.n_pivots;
      n_update += std::size_t(front.n_rows) * front.n_rows;
      n_vector += n;
      if (std::max(n_panel, n_update) > MOST_NUMBERS)
        throw UsageError(
            "the factor of the scene's matrix is too large for one device; set solver: preconditioner: "
            "schwarz, or divide the scene");
      if (node.parent == NO_PARENT) continue;
      const Supernode& parent = tree.supernodes[node.parent];
      for (const u32 row : node.rows) {
        const auto found = std::lower_bound(parent.rows.begin(), parent.rows.end(), row);
        places.push_back(row < parent.first + parent.n_pivots ? row - parent.first
                                                              : parent.n_pivots + u32(found - parent.rows.begin()));
      }
    }
    for (const u32 local : tree.order) order_.push_back(groups[g].nodes[local]);
    group_front_.push_back(u32(host_fronts_.size()));
  }
  upload(fronts_, host_fronts_);
  upload(children_, children);
  upload(places_, places);
  upload(front_nodes_, host_nodes_);
  panels_.resize(n_panel);
  updates_.resize(n_update);
  vectors_.resize(n_vector);
}

void DeviceFactor::list_blocks(std::span<const FactorGroup> groups) {
  std::vector<u32> row, column, source, place, stride;
  std::vector<char> is_placed(panels_.size(), false);  // of the first number of each block
  std::vector<u32> block_first(n_nodes_, 0), block_last(n_nodes_, 0), node_group(n_nodes_, NO_PARENT), lone;
  for (u32 g = 0; g < groups.size(); ++g) {
    const auto& [tree, pattern, nodes, group_source, world] = groups[g];
    std::vector<u32> owner(nodes.size());  // front of each position
    for (u32 s = 0; s < tree->supernodes.size(); ++s)
      std::fill_n(&owner[tree->supernodes[s].first], tree->supernodes[s].n_pivots, s);
    for (u32 c = 0; c < nodes.size(); ++c) {
      node_group[nodes[c]] = g;
      block_first[nodes[c]] = u32(row.size());
      for (u32 k = pattern->column_first[c]; k < pattern->column_first[c + 1]; ++k) {
        const u32 r = pattern->row[k], a = tree->position[r], b = tree->position[c];
        const u32 panel_column = std::min(a, b), behind = std::max(a, b), s = owner[panel_column];
        const Supernode& node = tree->supernodes[s];
        const FactorFront& front = host_fronts_[group_front_[g] + s];
        const u32 n = front.n_pivots + front.n_rows;
        const auto found = std::lower_bound(node.rows.begin(), node.rows.end(), behind);
        const u32 panel_row =
            behind < node.first + node.n_pivots ? behind - node.first : node.n_pivots + u32(found - node.rows.begin());
        row.push_back(nodes[r]);
        column.push_back(nodes[c]);
        source.push_back(group_source[k]);
        place.push_back(front.panel + 3 * panel_row + 3 * (panel_column - node.first) * n);
        stride.push_back(n | (a < b ? IS_TRANSPOSED : 0));
        is_placed[place.back()] = true;
      }
      block_last[nodes[c]] = u32(row.size());
    }
  }
  for (u32 node = 0; node < n_nodes_; ++node)
    if (node_group[node] == NO_PARENT) lone.push_back(node);
  upload(row_, row), upload(column_, column), upload(source_, source), upload(place_, place), upload(stride_, stride);
  block_first_.write(block_first), block_last_.write(block_last), node_group_.write(node_group);
  upload(lone_nodes_, lone);
  list_holes(is_placed);
}

void DeviceFactor::list_holes(const std::vector<char>& is_placed) {
  std::vector<u32> place, stride;
  for (const FactorFront& front : host_fronts_) {
    const u32 n = front.n_pivots + front.n_rows;
    for (u32 column = 0; column < front.n_pivots; column += 3)
      for (u32 row = column; row < n; row += 3) {  // what is above the diagonal nobody reads
        const u32 at = front.panel + row + column * n;
        if (is_placed[at]) continue;
        place.push_back(at);
        stride.push_back(n);
      }
  }
  upload(hole_place_, place), upload(hole_stride_, stride);
}

void DeviceFactor::start_factorize(const Buffer<f64>& matrix_blocks, const ContactElements& contacts,
                                   std::span<const char> world_is_active, const Buffer<f64>* gradient) {
  is_half_solved_ = gradient;
  if (group_world_.empty()) return;
  std::vector<u32> is_active;
  for (const u32 world : group_world_) is_active.push_back(world_is_active[world]);
  if (is_active != written_active_) {
    group_is_active_.write(is_active);
    written_active_ = std::move(is_active);
  }
  u32 n_contacts = 0;
  for (const Term* term : contacts.terms) n_contacts += u32(term->size());
  if (n_contacts > 0 && (contacts.terms.size() > 2 || !contacts.gather || !contacts.element_sites || !contacts.sites))
    throw std::logic_error("a factor on the device was given contacts without their sites");
  const u32 n_groups = u32(group_world_.size()), n = u32(row_.size());
  const auto blocks_of = [&](std::size_t term) -> const Buffer<f64>& {
    return n_contacts > 0 && term < contacts.terms.size() ? contacts.terms[term]->blocks() : no_numbers_;
  };
  const Gather* gather = n_contacts > 0 ? contacts.gather : nullptr;
  const u32 n_holes = u32(hole_place_.size()), n_items = PLACE_SHARES * n + 3 * n_holes;
  place_blocks_(n_items, n_items, n, n_groups, row_, column_, source_, place_, stride_, matrix_blocks, block_first_,
                block_last_, node_group_, n_contacts, n_contacts > 0 ? u32(contacts.terms[0]->size()) : 0,
                contacts.first_row, gather ? gather->offset() : no_indices_, gather ? gather->row() : no_indices_,
                gather ? gather->weight() : no_numbers_, gather ? *contacts.element_sites : no_indices_,
                gather ? *contacts.sites : no_sites_, blocks_of(0), blocks_of(1), n_holes, hole_place_, hole_stride_,
                failed_, panels_);
  for (u32 stage = 0; stage < factoring_.n_stages; ++stage) {
    const u32 first = factoring_.stage_first[stage];
    const u32 n_items = FACTOR_ITEMS * (factoring_.stage_first[stage + 1] - first);
    factor_fronts_(n_items, n_items, first, factoring_.first, factoring_.front, fronts_, children_, places_,
                   group_is_active_, panels_, updates_, failed_, u32(gradient != nullptr), front_nodes_,
                   gradient ? *gradient : no_numbers_, vectors_);
  }
  failed_.read_later(0, std::span(host_failed_));
}

std::optional<u32> DeviceFactor::failed() const {
  const auto found = std::find(host_failed_.begin(), host_failed_.end(), 1u);
  return found == host_failed_.end() ? std::nullopt : std::optional(u32(found - host_failed_.begin()));
}

void DeviceFactor::solve_stage(u32 stage, u32 parts, bool adds, const Buffer<f64>& residual,
                               Buffer<f64>& preconditioned) {
  const u32 first = solving_.stage_first[stage], n_tasks = solving_.stage_first[stage + 1] - first;
  // the nodes without factor are cleared once
  const bool clears = stage == 0 && (parts & BACKWARD) && !adds;
  const u32 n_lone = clears ? u32(lone_nodes_.size()) : 0, n_items = FACTOR_ITEMS * n_tasks + n_lone;
  factor_solve_(n_items, n_items, first, n_tasks, parts, u32(adds), n_lone, lone_nodes_, solving_.first, solving_.front,
                fronts_, children_, places_, front_nodes_, group_is_active_, failed_, panels_, residual, vectors_,
                preconditioned);
}

void DeviceFactor::start_apply(const Buffer<f64>& residual, bool adds, Buffer<f64>& preconditioned) {
  const u32 n = solving_.n_stages;
  if (n == 0) return adds ? void() : preconditioned.zero();
  const u32 forward = std::exchange(is_half_solved_, false) ? 0 : FORWARD;
  for (u32 stage = 0; forward && stage + 1 < n; ++stage) solve_stage(stage, FORWARD, adds, residual, preconditioned);
  solve_stage(n - 1, forward | BACKWARD, adds, residual, preconditioned);
  for (u32 stage = n - 1; stage-- > 0;) solve_stage(stage, BACKWARD, adds, residual, preconditioned);
}

std::vector<double> DeviceFactor::dense(u32 group) const {
  const std::vector<double> panels = panels_.read();
  std::vector<u32> position(n_nodes_, 0);
  std::size_t n_nodes = 0, before = 0;
  for (u32 f = group_front_[0]; f < group_front_[group]; ++f) before += host_fronts_[f].n_pivots / 3;
  for (u32 f = group_front_[group]; f < group_front_[group + 1]; ++f) n_nodes += host_fronts_[f].n_pivots / 3;
  for (std::size_t k = 0; k < n_nodes; ++k) position[order_[before + k]] = u32(k);
  std::vector<double> factor(9 * n_nodes * n_nodes, 0.0);
  for (u32 f = group_front_[group]; f < group_front_[group + 1]; ++f) {
    const FactorFront& front = host_fronts_[f];
    const u32 n = front.n_pivots + front.n_rows;
    const auto unknown = [&](u32 k) { return 3 * std::size_t(position[host_nodes_[front.nodes + k / 3]]) + k % 3; };
    for (u32 c = 0; c < front.n_pivots; ++c)
      for (u32 r = c; r < n; ++r) {
        const double value = panels[front.panel + r + std::size_t(c) * n];
        factor[unknown(r) + 3 * n_nodes * unknown(c)] = r == c ? 1 / value : value;
      }
  }
  return factor;
}

}  // namespace pvg
