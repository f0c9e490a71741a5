// Which rows each node sums up, applied on the device in a fixed order. Lists are built on the host, or, of elements
// that only the device knows, there (kernels/solve/node_rows.cl).
#pragma once
#include <optional>
#include <span>
#include <vector>

#include "host/device/device.hpp"
#include "host/physics/linear/world_reduce.hpp"
#include "solve/site.h"

namespace pvg {

// A list of elements whose rows begin at first_row; each element writes `stencil` rows.
struct RowBlock {
  std::span<const u32> sites;  // [n_elements x stencil]
  u32 first_row;
};

// Elements of four sites on the device, sorted by world.
struct DeviceElements {
  const Buffer<u32>& sites;        // [n x 4]
  u32 n;                           // or the room for them, of the first of two kinds
  const Buffer<u32>& world_first;  // [n_worlds + 1]
};

class Gather {
 public:
  Gather(Device& device, std::span<const Site> sites, std::size_t n_nodes);
  void set(std::span<const RowBlock> blocks);
  // The same lists for two kinds of elements whose rows follow each other from first_row on; and element_sites: the
  // sites of both [n x 4]. sites: of the device; chunks: of at most 64 nodes, which follow each other.
  void set_on_device(const DeviceElements& first, const DeviceElements& second, u32 first_row,
                     const Buffer<Site>& sites, const WorldChunks& chunks, Buffer<u32>& element_sites);
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
  struct Kernels {
    explicit Kernels(Device& device);
    Program program;
    Kernel count, fill;
    Buffer<u32> counts, totals;
  };
  std::optional<Kernels> kernels_;  // made when they are first asked for
};

}  // namespace pvg
