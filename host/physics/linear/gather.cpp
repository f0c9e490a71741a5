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

void Gather::apply(Kernel& gather_rows, const Buffer<u32>& node_is_fixed, const Buffer<f64>& rows, bool accumulate,
                   Buffer<f64>& node) const {
  gather_rows(n_nodes_, u32(n_nodes_), offset_, row_, weight_, node_is_fixed, rows, u32(accumulate), node);
}

}  // namespace pvg
