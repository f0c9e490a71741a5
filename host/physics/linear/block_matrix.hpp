// The Hessian of the terms whose elements never change, assembled on the device: a sparse matrix of 3 x 3 blocks over
// the nodes. A product reads each block once, where the elements' own dense blocks overlap several times.
#pragma once
#include <optional>
#include <span>
#include <vector>

#include "host/device/device.hpp"
#include "host/physics/linear/gather.hpp"
#include "host/physics/linear/term.hpp"
#include "host/physics/linear/world_reduce.hpp"
#include "solve/site.h"

namespace pvg {

// Which blocks there are, by rows; columns ascend. Every row that moves has its diagonal block, a fixed node has none.
struct MatrixPattern {
  std::vector<u32> first, column;  // [n_nodes + 1], [n_blocks]
  std::size_t n_nodes() const { return first.size() - 1; }
  std::size_t n_blocks() const { return column.size(); }
  u32 find(u32 row, u32 column) const;  // index of a block; NO_BLOCK where there is none
};
constexpr u32 NO_BLOCK = ~0u;

class BlockMatrix {
 public:
  // nodes: of each world, in their order; empty: all are of one
  BlockMatrix(Device& device, std::span<const Site> sites, std::span<const u32> node_is_fixed,
              std::span<Term* const> terms, std::span<const WorldRange> nodes = {});
  // The sum of the present blocks of the terms that it was made from, which write their upper halves into a buffer of
  // its own. worlds: [n_worlds] whose rows are wanted, the others' stay; or empty, then all are
  void assemble(std::span<const char> worlds = {});
  // All of it; and in the same launch, as gather_two_lists of solve/nodes.cl does, node: what the rows of two lists sum
  // up to, dx = 0, residual = -node  [n_nodes x 3]
  void assemble_and_gather(const Gather& first, const Gather& second, const Buffer<u32>& node_is_fixed,
                           const Buffer<f64>& rows, Buffer<f64>& node, Buffer<f64>& dx, Buffer<f64>& residual);
  // y = A x;  [n_nodes x 3]
  void multiply(const Buffer<f64>& x, Buffer<f64>& y);
  // y = A x + what these rows are to the nodes, if gather is given; and chunks.partial(): x . y over each chunk of at
  // most 64 nodes
  void multiply_and_dot(const Buffer<f64>& x, const Gather* gather, const Buffer<u32>& node_is_fixed,
                        const Buffer<f64>& rows, Buffer<f64>& y, WorldChunks& chunks);

  const MatrixPattern& pattern() const { return pattern_; }
  const Buffer<f64>& blocks() const { return blocks_; }  // [n_blocks x 9, N/m]
  Buffer<f64>& element_blocks() { return element_blocks_; }

 private:
  void find_parts(std::span<const Site> sites, std::span<const u32> node_is_fixed, std::span<Term* const> terms,
                  std::span<const WorldRange> nodes);

  MatrixPattern pattern_;
  Program program_;
  Kernel block_product_, block_product_and_dot_, assemble_blocks_;
  std::optional<Kernel> gather_and_assemble_;  // made when it is first asked for
  Buffer<u32> first_, column_;
  Buffer<f64> blocks_;
  Buffer<f64> element_blocks_;            // of all terms
  std::vector<u32> world_first_;          // [n_worlds + 1] of the blocks on and above the diagonal
  Buffer<u32> place_;                     // [n_upper_blocks x 2] in blocks_, and of the transpose
  Buffer<u32> part_first_, part_source_;  // what each is the sum of: by term, in it by element
  Buffer<f64> part_weight_;
};

}  // namespace pvg
