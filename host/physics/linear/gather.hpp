// Which rows each node sums up: built on the host, applied on the device in a fixed order.
#pragma once
#include <span>
#include <vector>

#include "host/device/device.hpp"
#include "solve/site.h"

namespace pvg {

// A list of elements whose rows begin at first_row; each element writes `stencil` rows.
struct RowBlock {
  std::span<const u32> sites;  // [n_elements x stencil]
  u32 first_row;
};

class Gather {
 public:
  Gather(Device& device, std::span<const Site> sites, std::size_t n_nodes);
  void set(std::span<const RowBlock> blocks);
  // node (+)= the weighted sum of its rows
  void apply(Kernel& gather_rows, const Buffer<u32>& node_is_fixed, const Buffer<f64>& rows, bool accumulate,
             Buffer<f64>& node) const;

  // [n_nodes + 1] into the entries: rows, and their weights
  const Buffer<u32>& offset() const { return offset_; }
  const Buffer<u32>& row() const { return row_; }
  const Buffer<f64>& weight() const { return weight_; }

 private:
  std::vector<Site> sites_;
  std::size_t n_nodes_;
  Buffer<u32> offset_, row_;
  Buffer<f64> weight_;
};

}  // namespace pvg
