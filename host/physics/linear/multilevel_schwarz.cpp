#include "host/physics/linear/multilevel_schwarz.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

namespace pvg {
namespace {

constexpr u32 N_COARSE = 4;
constexpr u32 N_PAIR_PARTS = N_COARSE * N_COARSE;
constexpr u32 LARGEST_WIDTH = 32;  // what a work-group's memory in the kernel is made for

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

std::vector<double> flat(const std::vector<std::array<double, 4>>& weights) {
  std::vector<double> numbers;
  for (const auto& weight : weights) numbers.insert(numbers.end(), weight.begin(), weight.end());
  return numbers;
}

std::vector<u32> blocks_within(u32 width, const std::vector<u32>& row, const std::vector<u32>& column) {
  std::vector<u32> within;
  for (u32 k = 0; k < row.size(); ++k)
    if (row[k] != NO_SLOT && row[k] / width == column[k] / width) within.push_back(k);
  return within;
}

}  // namespace

MultilevelSchwarz::Level::Level(Device& device, const SchwarzLevel& level, u32 stride_, const std::vector<u32>& row_,
                                const std::vector<u32>& column_)
    : width(level.width),
      stride(stride_),
      n_clusters(u32(level.n_clusters())),
      row(device, row_, "row slots"),
      column(device, column_, "column slots"),
      within(device, blocks_within(width, row_, column_), "blocks within clusters"),
      blocks(device, 0, "coarse blocks"),
      pair_first(device, 0, "first block of pair"),
      pair_source(device, 0, "blocks of pair"),
      parent(device, level.parent, "parent slots"),
      weights(device, flat(level.weights), "coarse functions"),
      matrices(device, std::size_t(n_clusters) * stride * stride, "cluster matrices"),
      inverse(device, std::size_t(n_clusters) * stride * stride, "cluster inverses"),
      restricted(device, std::size_t(n_clusters) * stride, "restricted residual"),
      z(device, std::size_t(n_clusters) * stride, "cluster corrections"),
      site_weights(device, 0, "coarse functions of sites"),
      part_pair_row(device, 0, "rows of contact blocks"),
      part_pair_column(device, 0, "columns of contact blocks"),
      part_first(device, 0, "first part of contact block"),
      part_source(device, 0, "sources of contact parts"),
      part_row(device, 0, "row sites of contact parts"),
      part_column(device, 0, "column sites of contact parts") {
  restricted.zero();
}

MultilevelSchwarz::MultilevelSchwarz(Device& device, const BlockMatrix& matrix, std::span<const Site> sites,
                                     const SchwarzNodes& nodes, u32 width, std::size_t most_levels)
    : matrix_(matrix),
      program_(device, "solve/multilevel_schwarz.cl"),
      coarsen_(program_.kernel("schwarz_coarsen")),
      place_(program_.kernel("schwarz_place")),
      add_contacts_(program_.kernel("schwarz_add_contacts")),
      invert_(program_.kernel("schwarz_invert")),
      gather_(program_.kernel("schwarz_gather")),
      restrict_(program_.kernel("schwarz_restrict")),
      solve_(program_.kernel("schwarz_solve")),
      scatter_(program_.kernel("schwarz_scatter")),
      add_exactly_(program_.kernel("schwarz_add_exactly")),
      node_of_slot_(device, 0, "node of slot"),
      slot_of_node_(device, 0, "slot of node"),
      failed_(device, 0, "failed") {
  const MatrixPattern& pattern = matrix.pattern();
  const SchwarzHierarchy hierarchy =
      make_schwarz_hierarchy(pattern, nodes, std::min(width, LARGEST_WIDTH), most_levels);
  if (hierarchy.levels.empty()) return;
  const SchwarzLevel& finest = hierarchy.levels.front();
  std::vector<u32> node_of_slot(finest.n_slots(), NO_SLOT), row, column;
  node_of_cluster_.assign(finest.n_clusters(), 0);
  for (u32 node = 0; node < pattern.n_nodes(); ++node) {
    const u32 slot = hierarchy.slot_of_node[node];
    if (slot == NO_SLOT) continue;
    node_of_slot[slot] = node;
    node_of_cluster_[slot / finest.width] = node;
  }
  refill(node_of_slot_, node_of_slot);
  refill(slot_of_node_, hierarchy.slot_of_node);
  for (u32 node = 0; node < pattern.n_nodes(); ++node)
    for (u32 k = pattern.first[node]; k < pattern.first[node + 1]; ++k) {
      row.push_back(hierarchy.slot_of_node[node]);
      column.push_back(hierarchy.slot_of_node[pattern.column[k]]);
    }
  levels_.reserve(hierarchy.levels.size());
  u32 n_clusters = 0;
  for (std::size_t l = 0; l < hierarchy.levels.size(); ++l) {
    Level& level = levels_.emplace_back(device, hierarchy.levels[l], stride_of(finest.width), row, column);
    level.first_cluster = std::exchange(n_clusters, n_clusters + level.n_clusters);
    if (l > 0) level.blocks.resize(9 * row.size());
    if (l + 1 < hierarchy.levels.size()) find_coarse_blocks(level, hierarchy.levels[l], row, column);
  }
  failed_.resize(n_clusters);
  has_failed_.resize(n_clusters);
  find_site_slots(sites, hierarchy);
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
    for (u32 a = 0; a < N_COARSE; ++a)
      for (u32 b = 0; b < N_COARSE; ++b) {
        row.push_back(shape.parent[from] + a);
        column.push_back(shape.parent[to] + b);
      }
  }
  level.n_pairs = u32(first.size());
  first.push_back(u32(order.size()));
  refill(level.pair_first, first);
  refill(level.pair_source, source);
}

// A site's nodes stand in neighbouring slots, in one cluster on every level.
void MultilevelSchwarz::find_site_slots(std::span<const Site> sites, const SchwarzHierarchy& hierarchy) {
  const u32 width = hierarchy.levels.front().width;
  std::vector<u32> slots(sites.size(), NO_SLOT);
  std::vector<std::array<double, 4>> weights(sites.size(), {0, 0, 0, 0});
  for (std::size_t s = 0; s < sites.size(); ++s) {
    slots[s] = hierarchy.slot_of_node[sites[s].node[0]];
    if (slots[s] == NO_SLOT) continue;
    for (std::size_t k = 0; k < 4; ++k) weights[s][k] = sites[s].weight[k];
    if (width < N_COARSE) std::fill(weights[s].begin() + 1, weights[s].end(), 0.0);
  }
  for (std::size_t l = 0; l < levels_.size(); ++l) {
    levels_[l].site_slot = slots;
    refill(levels_[l].site_weights, flat(weights));
    if (l + 1 == levels_.size()) break;
    const SchwarzLevel& shape = hierarchy.levels[l];
    for (std::size_t s = 0; s < sites.size(); ++s) {
      if (slots[s] == NO_SLOT) continue;
      std::array<double, 4> coarse = {0, 0, 0, 0};
      for (u32 k = 0; k < 4; ++k)
        for (u32 b = 0; b < N_COARSE && weights[s][k] != 0; ++b)
          coarse[b] += weights[s][k] * shape.weights[slots[s] + k][b];
      weights[s] = coarse;
      slots[s] = shape.parent[slots[s] / width];
    }
  }
}

void MultilevelSchwarz::start_factorize(std::span<const Term* const> contacts) {
  const Buffer<f64>* blocks = &matrix_.blocks();
  for (std::size_t l = 0; l < levels_.size(); ++l) {
    Level& level = levels_[l];
    level.matrices.zero();
    const u32 n_within = u32(level.within.size());
    place_(n_within, n_within, level.width, level.stride, level.within, level.row, level.column, *blocks,
           level.matrices);
    for (const Term* term : contacts) add_contacts(level, *term);
    const u32 n = u32(GROUP_SIZE) * level.n_clusters;
    invert_(n, n, level.stride, level.first_cluster, level.matrices, level.inverse, failed_);
    if (l + 1 == levels_.size()) break;
    const u32 n_parts = N_PAIR_PARTS * level.n_pairs;
    coarsen_(n_parts, n_parts, level.pair_first, level.pair_source, level.row, level.column, level.weights, *blocks,
             levels_[l + 1].blocks);
    blocks = &levels_[l + 1].blocks;
  }
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

void MultilevelSchwarz::add_contacts(Level& level, const Term& contacts) {
  constexpr u32 STENCIL = 4;
  std::vector<std::array<u32, 2>> slots;  // of each part's two sites
  std::vector<std::array<u32, 3>> parts;  // source, row site, column site
  for (u32 e = 0; e < contacts.size(); ++e)
    for (u32 a = 0; a < STENCIL; ++a)
      for (u32 b = 0; b < STENCIL; ++b) {
        const u32 row = contacts.sites()[STENCIL * e + a], column = contacts.sites()[STENCIL * e + b];
        const u32 row_slot = level.site_slot[row], column_slot = level.site_slot[column];
        if (row_slot == NO_SLOT || column_slot == NO_SLOT) continue;
        if (row_slot / level.width != column_slot / level.width) continue;
        slots.push_back({row_slot, column_slot});
        parts.push_back({9 * STENCIL * STENCIL * e + 9 * STENCIL * a + 3 * b, row, column});
      }
  if (parts.empty()) return;
  std::vector<u32> pair_row, pair_column, first, source, row, column;
  const std::vector<u32> order = sorted_order(slots);
  for (u32 k = 0; k < order.size(); ++k) {
    if (k == 0 || slots[order[k]] != slots[order[k - 1]]) {
      first.push_back(k);
      pair_row.push_back(slots[order[k]][0]);
      pair_column.push_back(slots[order[k]][1]);
    }
    source.push_back(parts[order[k]][0]);
    row.push_back(parts[order[k]][1]);
    column.push_back(parts[order[k]][2]);
  }
  const u32 n = N_PAIR_PARTS * u32(first.size());
  first.push_back(u32(order.size()));
  refill(level.part_pair_row, pair_row);
  refill(level.part_pair_column, pair_column);
  refill(level.part_first, first);
  refill(level.part_source, source);
  refill(level.part_row, row);
  refill(level.part_column, column);
  add_contacts_(n, n, level.width, level.stride, level.part_pair_row, level.part_pair_column, level.part_first,
                level.part_source, level.part_row, level.part_column, level.site_weights, contacts.blocks(),
                level.matrices);
}

void MultilevelSchwarz::apply(const Buffer<f64>& residual, Buffer<f64>& preconditioned) {
  const u32 n_nodes = u32(slot_of_node_.size()), n_slots = u32(node_of_slot_.size());
  if (levels_.empty()) {
    preconditioned.zero();
    return;
  }
  const Level& finest = levels_.front();
  gather_(n_slots, n_slots, finest.width, finest.stride, node_of_slot_, residual, finest.restricted);
  for (std::size_t l = 0; l + 1 < levels_.size(); ++l) {
    const u32 n = N_COARSE * levels_[l].n_clusters;
    restrict_(n, n, levels_[l].width, levels_[l].stride, levels_[l].parent, levels_[l].weights, levels_[l].restricted,
              levels_[l + 1].restricted);
  }
  for (std::size_t l = levels_.size(); l-- > 0;) {
    Level& level = levels_[l];
    const u32 n = level.n_clusters * level.stride, has_coarser = l + 1 < levels_.size();
    const Buffer<float>& coarse = has_coarser ? levels_[l + 1].z : level.z;
    solve_(n, n, level.width, level.stride, level.inverse, level.restricted, has_coarser, level.parent, level.weights,
           coarse, level.z);
  }
  scatter_(n_nodes, n_nodes, finest.width, finest.stride, slot_of_node_, finest.z, preconditioned);
}

void MultilevelSchwarz::add_exactly(const Buffer<f64>& residual, Buffer<f64>& preconditioned) {
  if (levels_.empty()) return;
  const Level& level = levels_.front();
  const u32 n = level.n_clusters * level.stride;
  add_exactly_(n, n, level.width, level.stride, node_of_slot_, level.matrices, residual, preconditioned);
}

std::size_t MultilevelSchwarz::n_clusters() const { return levels_.empty() ? 0 : levels_.front().n_clusters; }

std::size_t MultilevelSchwarz::n_bytes() const {
  std::size_t bytes = 0;
  for (const Level& level : levels_) bytes += sizeof(float) * level.inverse.size();
  return bytes;
}

}  // namespace pvg
