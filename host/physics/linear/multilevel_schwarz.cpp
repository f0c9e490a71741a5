#include "host/physics/linear/multilevel_schwarz.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

namespace pvg {
namespace {

constexpr u32 N_FUNCTIONS = 4;
constexpr u32 N_PAIR_PARTS = N_FUNCTIONS * N_FUNCTIONS;
constexpr u32 LONG_PAIR = 64;        // parts; as in solve/multilevel_schwarz.cl
constexpr u32 LARGEST_WIDTH = 32;    // what a work-group's memory in the kernel is made for
constexpr u32 IN_SECOND = 1u << 31;  // as in solve/multilevel_schwarz.cl

u32 stride_of(u32 width) { return (3 * width + 3) / 4 * 4; }

// Indices of keys, sorted by key; equal ones keep their order.
template <class Key>
std::vector<u32> sorted_order(const std::vector<Key>& keys) {
  std::vector<u32> order(keys.size());
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(), [&](u32 a, u32 b) { return keys[a] < keys[b]; });
  return order;
}

template <class T>
void refill(Buffer<T>& buffer, const std::vector<T>& values) {
  buffer.resize(values.size());
  buffer.write(values);
}

using Weights = std::array<double, N_FUNCTIONS>;

std::vector<double> flat(const std::vector<Weights>& weights) {
  std::vector<double> numbers;
  for (const Weights& weight : weights) numbers.insert(numbers.end(), weight.begin(), weight.end());
  return numbers;
}

// what the functions of one level, weighed like this from slot `slot` on, are on the next one
Weights coarsened(const SchwarzLevel& level, u32 slot, const Weights& weight) {
  Weights coarse = {0, 0, 0, 0};
  for (u32 k = 0; k < N_FUNCTIONS; ++k)
    for (u32 b = 0; b < N_FUNCTIONS && weight[k] != 0; ++b) coarse[b] += weight[k] * level.weights[slot + k][b];
  return coarse;
}

}  // namespace

MultilevelSchwarz::Level::Level(Device& device, const SchwarzLevel& level, const std::vector<u32>& row_,
                                const std::vector<u32>& column_)
    : n_clusters(u32(level.n_clusters())),
      row(device, row_, "row slots"),
      column(device, column_, "column slots"),
      pair_first(device, 0, "first block of pair"),
      pair_source(device, 0, "blocks of pair"),
      weights(device, flat(level.weights), "coarse functions") {}

MultilevelSchwarz::MultilevelSchwarz(Device& device, const BlockMatrix& matrix, std::span<const Site> sites,
                                     const SchwarzNodes& nodes, u32 width, std::size_t most_levels)
    : matrix_(matrix),
      program_(device, "solve/multilevel_schwarz.cl"),
      coarsen_(program_.kernel("schwarz_coarsen")),
      place_(program_.kernel("schwarz_place")),
      add_contacts_(program_.kernel("schwarz_add_contacts")),
      invert_(program_.kernel("schwarz_invert")),
      restrict_(program_.kernel("schwarz_restrict")),
      solve_(program_.kernel("schwarz_solve")),
      prolong_(program_.kernel("schwarz_prolong")),
      node_of_slot_(device, 0, "node of slot"),
      slot_of_node_(device, 0, "slot of node"),
      failed_(device, 0, "failed"),
      coarse_blocks_(device, 0, "coarse blocks"),
      within_source_(device, 0, "blocks within clusters"),
      within_row_(device, 0, "rows within clusters"),
      within_column_(device, 0, "columns within clusters"),
      matrices_(device, 0, "cluster matrices"),
      inverse_(device, 0, "cluster inverses"),
      z_(device, 0, "cluster corrections"),
      functions_(device, 0, "functions of slots"),
      parts_(device, 0, "parts of restricted residuals"),
      coarser_(device, 0, "coarser functions"),
      level_(device, 0, "level of cluster"),
      member_first_(device, 0, "first cluster of functions"),
      member_(device, 0, "clusters of functions"),
      site_weights_(device, 0, "coarse functions of sites"),
      part_pair_row_(device, 0, "rows of contact blocks"),
      part_pair_column_(device, 0, "columns of contact blocks"),
      part_first_(device, 0, "first part of contact block"),
      long_pairs_(device, 0, "contact blocks with many parts"),
      part_source_(device, 0, "sources of contact parts"),
      part_row_(device, 0, "row sites of contact parts"),
      part_column_(device, 0, "column sites of contact parts") {
  const MatrixPattern& pattern = matrix.pattern();
  const SchwarzHierarchy hierarchy =
      make_schwarz_hierarchy(pattern, nodes, std::min(width, LARGEST_WIDTH), most_levels);
  if (hierarchy.levels.empty()) return;
  const SchwarzLevel& finest = hierarchy.levels.front();
  width_ = finest.width;
  stride_ = stride_of(width_);
  n_coarser_ = u32(hierarchy.levels.size() - 1);
  std::vector<u32> node_of_slot(finest.n_slots(), NO_SLOT), row, column;
  node_of_cluster_.assign(finest.n_clusters(), 0);
  for (u32 node = 0; node < pattern.n_nodes(); ++node) {
    const u32 slot = hierarchy.slot_of_node[node];
    if (slot == NO_SLOT) continue;
    node_of_slot[slot] = node;
    node_of_cluster_[slot / width_] = node;
  }
  refill(node_of_slot_, node_of_slot);
  refill(slot_of_node_, hierarchy.slot_of_node);
  for (u32 node = 0; node < pattern.n_nodes(); ++node)
    for (u32 k = pattern.first[node]; k < pattern.first[node + 1]; ++k) {
      row.push_back(hierarchy.slot_of_node[node]);
      column.push_back(hierarchy.slot_of_node[pattern.column[k]]);
    }
  levels_.reserve(hierarchy.levels.size());
  Places places;
  u32 n_clusters = 0, n_coarse_blocks = 0;
  for (std::size_t l = 0; l < hierarchy.levels.size(); ++l) {
    Level& level = levels_.emplace_back(device, hierarchy.levels[l], row, column);
    level.first_cluster = std::exchange(n_clusters, n_clusters + level.n_clusters);
    if (l > 0) level.first_block = std::exchange(n_coarse_blocks, n_coarse_blocks + u32(row.size()));
    add_places(level, row, column, places);
    if (l + 1 < hierarchy.levels.size()) find_coarse_blocks(level, hierarchy.levels[l], row, column);
  }
  refill(within_source_, places.source);
  refill(within_row_, places.row);
  refill(within_column_, places.column);
  coarse_blocks_.resize(9 * std::size_t(n_coarse_blocks));
  matrices_.resize(std::size_t(n_clusters) * stride_ * stride_);
  inverse_.resize(matrices_.size());
  z_.resize(std::size_t(n_clusters) * stride_);
  failed_.resize(n_clusters);
  has_failed_.resize(n_clusters);
  find_functions(hierarchy);
  find_site_slots(sites, hierarchy);
}

u32 MultilevelSchwarz::position(const Level& level, u32 slot) const {
  return (level.first_cluster + slot / width_) * stride_ + 3 * (slot % width_);
}

void MultilevelSchwarz::add_places(const Level& level, const std::vector<u32>& row, const std::vector<u32>& column,
                                   Places& places) const {
  const bool is_first = level.first_cluster == 0;
  for (u32 k = 0; k < row.size(); ++k)
    if (row[k] != NO_SLOT && row[k] / width_ == column[k] / width_) {
      places.source.push_back(is_first ? k : (level.first_block + k) | IN_SECOND);
      places.row.push_back(position(level, row[k]));
      places.column.push_back(3 * (column[k] % width_));
    }
}

// Pairs of clusters that blocks of this level connect; row, column: of this level's blocks, then of the next one's.
void MultilevelSchwarz::find_coarse_blocks(Level& level, const SchwarzLevel& shape, std::vector<u32>& row,
                                           std::vector<u32>& column) {
  std::vector<u32> present;
  std::vector<std::array<u32, 2>> pair_of_block;
  for (u32 k = 0; k < row.size(); ++k) {
    if (row[k] == NO_SLOT) continue;
    present.push_back(k);
    pair_of_block.push_back({row[k] / shape.width, column[k] / shape.width});
  }
  const std::vector<u32> order = sorted_order(pair_of_block);
  std::vector<u32> first, source;
  row.clear();
  column.clear();
  for (u32 k = 0; k < order.size(); ++k) {
    source.push_back(present[order[k]]);
    const auto& [from, to] = pair_of_block[order[k]];
    if (k > 0 && pair_of_block[order[k]] == pair_of_block[order[k - 1]]) continue;
    first.push_back(k);
    for (u32 a = 0; a < N_FUNCTIONS; ++a)
      for (u32 b = 0; b < N_FUNCTIONS; ++b) {
        row.push_back(shape.parent[from] + a);
        column.push_back(shape.parent[to] + b);
      }
  }
  level.n_pairs = u32(first.size());
  first.push_back(u32(order.size()));
  refill(level.pair_first, first);
  refill(level.pair_source, source);
}

// Of each slot of the first level the functions of all coarser ones, P_l = W_0 ... W_l-1, and the clusters of the first
// level that each coarser function is of.
void MultilevelSchwarz::find_functions(const SchwarzHierarchy& hierarchy) {
  const SchwarzLevel& finest = hierarchy.levels.front();
  const u32 n_finest = u32(finest.n_clusters()), fours = width_ / N_FUNCTIONS;
  std::vector<float> functions(finest.n_slots() * n_coarser_ * N_FUNCTIONS);
  std::vector<u32> coarser(std::size_t(n_finest) * n_coarser_), level_of;
  std::vector<std::vector<u32>> members((failed_.size() - n_finest) * fours);
  std::vector<Weights> weights = finest.weights;  // of each slot's functions on the next level
  std::vector<u32> cluster_of(n_finest);          // on the present level
  std::iota(cluster_of.begin(), cluster_of.end(), 0u);
  for (u32 l = 0; l < levels_.size(); ++l) level_of.insert(level_of.end(), levels_[l].n_clusters, l);
  for (u32 l = 0; l < n_coarser_; ++l)
    for (u32 c = 0; c < n_finest; ++c) {
      const u32 slot = hierarchy.levels[l].parent[cluster_of[c]];
      const u32 cluster = levels_[l + 1].first_cluster + slot / width_;
      coarser[c * n_coarser_ + l] = position(levels_[l + 1], slot);
      members[(cluster - n_finest) * fours + slot % width_ / N_FUNCTIONS].push_back(c);
      for (u32 s = c * width_; s < (c + 1) * width_; ++s) {
        for (u32 a = 0; a < N_FUNCTIONS; ++a)
          functions[(std::size_t(s) * n_coarser_ + l) * N_FUNCTIONS + a] = float(weights[s][a]);
        weights[s] = coarsened(hierarchy.levels[l + 1], slot, weights[s]);
      }
      cluster_of[c] = slot / width_;
    }
  std::vector<u32> first = {0}, member;
  for (const std::vector<u32>& own : members) {
    member.insert(member.end(), own.begin(), own.end());
    first.push_back(u32(member.size()));
  }
  refill(functions_, functions);
  refill(coarser_, coarser);
  refill(level_, level_of);
  refill(member_first_, first);
  refill(member_, member);
  parts_.resize(std::size_t(n_finest) * n_coarser_ * 3 * N_FUNCTIONS);
}

// A site's nodes stand in neighbouring slots, in one cluster on every level.
void MultilevelSchwarz::find_site_slots(std::span<const Site> sites, const SchwarzHierarchy& hierarchy) {
  n_sites_ = u32(sites.size());
  std::vector<u32> slots(sites.size(), NO_SLOT);
  std::vector<Weights> weights(sites.size(), {0, 0, 0, 0});
  for (std::size_t s = 0; s < sites.size(); ++s) {
    slots[s] = hierarchy.slot_of_node[sites[s].node[0]];
    if (slots[s] == NO_SLOT) continue;
    for (std::size_t k = 0; k < 4; ++k) weights[s][k] = sites[s].weight[k];
    if (width_ < N_FUNCTIONS) std::fill(weights[s].begin() + 1, weights[s].end(), 0.0);
  }
  std::vector<double> all;
  for (std::size_t l = 0; l < levels_.size(); ++l) {
    levels_[l].site_slot = slots;
    const std::vector<double> own = flat(weights);
    all.insert(all.end(), own.begin(), own.end());
    if (l + 1 == levels_.size()) break;
    const SchwarzLevel& shape = hierarchy.levels[l];
    for (std::size_t s = 0; s < sites.size(); ++s) {
      if (slots[s] == NO_SLOT) continue;
      weights[s] = coarsened(shape, slots[s], weights[s]);
      slots[s] = shape.parent[slots[s] / width_];
    }
  }
  refill(site_weights_, all);
}

void MultilevelSchwarz::start_factorize(std::span<const Term* const> contacts) {
  if (levels_.empty()) return;
  const Buffer<f64>* blocks = &matrix_.blocks();
  for (std::size_t l = 0; l + 1 < levels_.size(); ++l) {
    Level& level = levels_[l];
    const u32 n_parts = N_PAIR_PARTS * level.n_pairs;
    coarsen_(n_parts, n_parts, level.pair_first, level.pair_source, level.row, level.column, level.weights, *blocks,
             level.first_block, levels_[l + 1].first_block, coarse_blocks_);
    blocks = &coarse_blocks_;
  }
  matrices_.zero();
  const u32 n_within = u32(within_source_.size());
  place_(n_within, n_within, stride_, within_source_, within_row_, within_column_, matrix_.blocks(), coarse_blocks_,
         matrices_);
  add_contacts(contacts);
  const u32 n = u32(GROUP_SIZE * failed_.size());
  invert_(n, n, stride_, matrices_, inverse_, failed_);
  failed_.read_later(0, std::span(has_failed_));
}

std::optional<u32> MultilevelSchwarz::failed() const {
  const auto found = std::find(has_failed_.begin(), has_failed_.end(), 1u);
  if (found == has_failed_.end()) return std::nullopt;
  const std::size_t cluster = std::size_t(found - has_failed_.begin());
  return node_of_cluster_[cluster < levels_.front().n_clusters ? cluster : 0];
}

std::optional<u32> MultilevelSchwarz::factorize(std::span<const Term* const> contacts) {
  start_factorize(contacts);
  matrix_.blocks().memory().device().finish();
  return failed();
}

void MultilevelSchwarz::list_contacts(std::span<const Term* const> contacts) {
  constexpr u32 STENCIL = 4;
  std::vector<std::array<u32, 2>> places;  // where each part's block begins
  std::vector<std::array<u32, 3>> parts;   // source, row site, column site
  for (u32 l = 0; l < levels_.size(); ++l)
    for (u32 t = 0; t < contacts.size(); ++t) {
      const std::span<const u32> sites = contacts[t]->sites();
      for (u32 e = 0; e < contacts[t]->size(); ++e)
        for (u32 a = 0; a < STENCIL; ++a)
          for (u32 b = 0; b < STENCIL; ++b) {
            const u32 row = sites[STENCIL * e + a], column = sites[STENCIL * e + b];
            const u32 row_slot = levels_[l].site_slot[row], column_slot = levels_[l].site_slot[column];
            if (row_slot == NO_SLOT || column_slot == NO_SLOT) continue;
            if (row_slot / width_ != column_slot / width_) continue;
            places.push_back({position(levels_[l], row_slot), 3 * (column_slot % width_)});
            parts.push_back({(9 * STENCIL * STENCIL * e + 9 * STENCIL * a + 3 * b) | (t > 0 ? IN_SECOND : 0),
                             l * n_sites_ + row, l * n_sites_ + column});
          }
    }
  std::vector<u32> pair_row, pair_column, first, source, row, column;
  const std::vector<u32> order = sorted_order(places);
  for (u32 k = 0; k < order.size(); ++k) {
    if (k == 0 || places[order[k]] != places[order[k - 1]]) {
      first.push_back(k);
      pair_row.push_back(places[order[k]][0]);
      pair_column.push_back(places[order[k]][1]);
    }
    source.push_back(parts[order[k]][0]);
    row.push_back(parts[order[k]][1]);
    column.push_back(parts[order[k]][2]);
  }
  n_part_pairs_ = u32(first.size());
  first.push_back(u32(order.size()));
  std::vector<u32> long_pairs;
  for (u32 pair = 0; pair < n_part_pairs_; ++pair)
    if (first[pair + 1] - first[pair] > LONG_PAIR) long_pairs.push_back(pair);
  refill(long_pairs_, long_pairs);
  refill(part_pair_row_, pair_row);
  refill(part_pair_column_, pair_column);
  refill(part_first_, first);
  refill(part_source_, source);
  refill(part_row_, row);
  refill(part_column_, column);
}

void MultilevelSchwarz::add_contacts(std::span<const Term* const> contacts) {
  std::vector<std::vector<u32>> sites;
  for (const Term* term : contacts) sites.push_back(term->sites());
  if (sites != listed_sites_) {  // late iterations of Newton's method mostly keep the contacts
    listed_sites_ = std::move(sites);
    list_contacts(contacts);
  }
  if (n_part_pairs_ == 0) return;
  const u32 group = u32(GROUP_SIZE), n_short_groups = (N_PAIR_PARTS * n_part_pairs_ + group - 1) / group;
  const u32 n = group * (n_short_groups + N_PAIR_PARTS * u32(long_pairs_.size()));
  const Buffer<f64>& first_blocks = contacts.front()->blocks();
  add_contacts_(n, n, n_part_pairs_, stride_, part_pair_row_, part_pair_column_, part_first_, long_pairs_, part_source_,
                part_row_, part_column_, site_weights_, first_blocks,
                contacts.size() > 1 ? contacts[1]->blocks() : first_blocks, matrices_);
}

void MultilevelSchwarz::apply(const Buffer<f64>& residual, Buffer<f64>& preconditioned, const MultilevelSchwarz* exact,
                              WorldChunks& chunks) {
  const u32 n_finest = u32(n_clusters()), n_all = u32(failed_.size()), n_parts = n_finest * n_coarser_;
  const u32 per_group = std::max(1u, u32(GROUP_SIZE) / stride_);
  const u32 n_solve = u32(GROUP_SIZE) * ((n_all + per_group - 1) / per_group);
  const u32 n_chunk_items = u32(GROUP_SIZE * chunks.n_chunks());
  if (levels_.empty()) {
    preconditioned.zero();
    chunks.partial().zero();
    return;
  }
  restrict_(n_parts, n_parts, width_, n_coarser_, node_of_slot_, functions_, residual, parts_);
  solve_(n_solve, n_solve, n_all, n_finest, width_, stride_, n_coarser_, node_of_slot_, level_, member_first_, member_,
         parts_, residual, inverse_, z_);
  const bool has_exact = exact && !exact->levels_.empty();
  const MultilevelSchwarz& added = has_exact ? *exact : *this;
  prolong_(n_chunk_items, n_chunk_items, chunks.chunks(), width_, stride_, n_coarser_, slot_of_node_, coarser_,
           functions_, z_, u32(has_exact), added.width_, added.stride_, added.slot_of_node_, added.node_of_slot_,
           added.matrices_, residual, preconditioned, chunks.partial());
}

}  // namespace pvg
