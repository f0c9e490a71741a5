#include "host/physics/linear/gather.hpp"

namespace pvg {

Gather::Gather(Device& device, std::span<const Site> sites, std::size_t n_nodes)
    : sites_(sites.begin(), sites.end()),
      n_nodes_(n_nodes),
      offset_(device, n_nodes + 1, "offset"),
      row_(device, 0, "row"),
      weight_(device, 0, "weight") {
  set({});
}

void Gather::set(std::span<const RowBlock> blocks) {
  // a counting sort by node: rows of one node stay in ascending order
  std::vector<u32> offset(n_nodes_ + 1, 0);
  const auto for_each_entry = [&](const auto& visit) {
    for (const RowBlock& block : blocks)
      for (std::size_t r = 0; r < block.sites.size(); ++r) {
        const Site& site = sites_[block.sites[r]];
        for (int k = 0; k < 4; ++k)
          if (site.weight[k] != 0) visit(site.node[k], u32(block.first_row + r), site.weight[k]);
      }
  };
  for_each_entry([&](u32 node, u32, double) { ++offset[node + 1]; });
  for (std::size_t i = 0; i < n_nodes_; ++i) offset[i + 1] += offset[i];
  std::vector<u32> row(offset.back()), next(offset.begin(), offset.end() - 1);
  std::vector<double> weight(offset.back());
  for_each_entry([&](u32 node, u32 r, double w) {
    row[next[node]] = r;
    weight[next[node]++] = w;
  });
  offset_.write(offset);
  row_.resize(row.size());
  row_.write(row);
  weight_.resize(weight.size());
  weight_.write(weight);
}

Gather::Kernels::Kernels(Device& device)
    : program(device, "solve/node_rows.cl"),
      count(program.kernel("node_rows_count")),
      fill(program.kernel("node_rows_fill")),
      counts(device, 0, "counts of nodes"),
      totals(device, 0, "counts of chunks") {}

void Gather::set_on_device(const DeviceElements& first, const DeviceElements& second, u32 first_row,
                           const Buffer<Site>& sites, const WorldChunks& chunks, Buffer<u32>& element_sites) {
  constexpr std::size_t SITES = 4, MOST_ENTRIES = 4 * SITES;  // of an element
  if (!kernels_) kernels_.emplace(offset_.memory().device());
  const std::size_t n = first.n + second.n;
  element_sites.resize(SITES * n);
  row_.resize(MOST_ENTRIES * n);
  weight_.resize(MOST_ENTRIES * n);
  kernels_->counts.resize(n_nodes_);
  kernels_->totals.resize(chunks.n_chunks());
  const u32 n_items = u32(GROUP_SIZE * chunks.n_chunks());
  kernels_->count(n_items, n_items, chunks.chunks(), u32(first.world_first.size() - 1), first.n, second.n,
                  first.world_first, second.world_first, first.sites, second.sites, sites, element_sites,
                  kernels_->counts, kernels_->totals);
  kernels_->fill(n_items, n_items, u32(chunks.n_chunks()), chunks.chunks(), first.n, first.world_first,
                 second.world_first, first.sites, second.sites, sites, kernels_->counts, kernels_->totals, first_row,
                 offset_, row_, weight_);
}

void Gather::apply(Kernel& gather_rows, const Buffer<u32>& node_is_fixed, const Buffer<f64>& rows, bool accumulate,
                   Buffer<f64>& node) const {
  gather_rows(n_nodes_, u32(n_nodes_), offset_, row_, weight_, node_is_fixed, rows, u32(accumulate), node);
}

}  // namespace pvg
