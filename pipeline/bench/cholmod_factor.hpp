// The yardstick of the sparse factor: CHOLMOD with its own ordering, where CMake found it. One thread, but for its
// BLAS.
#pragma once
#include <memory>
#include <span>

#include "host/physics/linear/block_matrix.hpp"

namespace pvg {

class CholmodFactor {
 public:
  // orders and analyses. blocks of nodes that are fixed do not appear in the pattern.
  explicit CholmodFactor(const MatrixPattern& pattern);
  ~CholmodFactor();
  // blocks: [n_blocks x 9]. False where the matrix is not positive definite.
  bool factorize(std::span<const double> blocks);
  void solve(std::span<double> x);  // in place [n_nodes x 3]; what is fixed becomes 0
  std::size_t n_numbers() const;    // stored in the factor

  static bool is_there();  // else the constructor throws a logic_error

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace pvg
