// Preconditioned conjugate gradients over all worlds at once; matrix and preconditioner are products
// (kernels/solve/conjugate_gradients.cl).
#pragma once
#include <functional>
#include <vector>

#include "host/device/device.hpp"
#include "host/physics/linear/world_reduce.hpp"
#include "solve/cg_world.h"

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
                 const std::vector<char>& world_is_active, double tolerance, int max_iterations, Buffer<f64>& dx);

  // The same without waiting: starts some iterations and to read how far they came. After the device was waited for
  // ended() tells whether they were enough; go_on() starts more.
  void start(Product product, Product precondition, const Buffer<f64>& gradient,
             const std::vector<char>& world_is_active, double tolerance, int max_iterations, Buffer<f64>& dx);
  bool ended() const;
  void go_on();
  bool may_have_ended() const { return n_started_ >= n_last_; }  // as far as the last solve tells, without looking
  CgReport report();

 private:
  struct Problem {
    Product product, precondition;
    double tolerance;
    int max_iterations;
    const Buffer<f64>* gradient;
    Buffer<f64>* dx;
  };
  bool renew_z();  // and whether the chunks of r . z were summed
  void test();
  bool joins_launches() const;

  Device* device_;
  std::size_t n_nodes_, n_worlds_;
  Program program_;
  Kernel start_, begin_, test_, test_residual_, step_length_, advance_, turn_;
  WorldReduce reduce_;
  WorldChunks chunks_;
  Buffer<u32> node_world_, is_wanted_;
  Buffer<CgWorld> worlds_;
  Buffer<f64> residual_, preconditioned_, direction_, product_, residual_partial_;
  std::vector<char> wanted_;  // what is_wanted_ holds
  Problem problem_{};
  std::vector<CgWorld> read_;   // [n_worlds] as the device had them
  int n_started_ = 0;           // iterations
  int n_last_ = 1;              // of the last solve
  bool was_tested_ = true;      // in the last iteration, in the preconditioner's norm
  bool residual_tells_ = true;  // where one iteration is enough; false since the residual missed it once
};

}  // namespace pvg
