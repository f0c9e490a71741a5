// Preconditioned conjugate gradients over all worlds at once; matrix and preconditioner are products
// (kernels/solve/conjugate_gradients.cl).
#pragma once
#include <functional>
#include <vector>

#include "host/device/device.hpp"
#include "host/physics/linear/world_reduce.hpp"

namespace pvg {

struct CgReport {
  std::vector<int> iterations;      // [n_worlds]
  std::vector<char> has_converged;  // [n_worlds]
};

class ConjugateGradients {
 public:
  ConjugateGradients(Device& device, const std::vector<u32>& node_world, std::size_t n_worlds,
                     const std::vector<WorldRange>& node_ranges);
  // Solves H dx = -gradient in the worlds that are active; dx = 0 in the others.
  // product(direction, out): out = H direction;  precondition(residual, out): out = M^-1 residual;  all vectors
  // [n_nodes x 3]
  using Product = std::function<void(const Buffer<f64>&, Buffer<f64>&)>;
  CgReport solve(const Product& product, const Product& precondition, const Buffer<f64>& gradient,
                 std::vector<char> world_is_active, double tolerance, int max_iterations, Buffer<f64>& dx);

 private:
  std::size_t n_nodes_, n_worlds_;
  Program program_;
  Kernel start_, advance_, turn_;
  WorldReduce reduce_;
  WorldChunks chunks_;
  Buffer<u32> node_world_, is_active_;
  Buffer<f64> residual_, preconditioned_, direction_, product_, rz_, rz_old_, php_;
};

}  // namespace pvg
