// The Hessian of the terms whose elements never change, assembled on the device: a sparse matrix of 3 x 3 blocks over
// the nodes. A product reads each block once, where the elements' own dense blocks overlap several times.
#pragma once
#include <span>
#include <vector>

#include "host/device/device.hpp"
#include "host/physics/linear/term.hpp"
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
  BlockMatrix(Device& device, std::span<const Site> sites, std::span<const u32> node_is_fixed,
              std::span<Term* const> terms);
  // the sum of the terms' present blocks; the terms are those that it was made from
  void assemble(std::span<Term* const> terms);
  // y = A x;  [n_nodes x 3]
  void multiply(const Buffer<f64>& x, Buffer<f64>& y);

  const MatrixPattern& pattern() const { return pattern_; }
  const Buffer<f64>& blocks() const { return blocks_; }  // [n_blocks x 9, N/m]

 private:
  // what one term adds, by block of the matrix
  struct Parts {
    Buffer<u32> touched, first, source;
    Buffer<f64> weight;
  };
  Parts find_parts(Device& device, std::span<const Site> sites, std::span<const u32> node_is_fixed,
                   const Term& term) const;

  MatrixPattern pattern_;
  Program program_;
  Kernel block_product_, add_element_blocks_;
  Buffer<u32> first_, column_;
  Buffer<f64> blocks_;
  std::vector<Parts> parts_;  // per term
};

}  // namespace pvg
