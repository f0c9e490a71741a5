// Preconditioned conjugate gradients over all worlds at once; matrix and preconditioner are products
// (kernels/solve/conjugate_gradients.cl).
#pragma once
#include <functional>
#include <optional>
#include <vector>

#include "host/device/device.hpp"
#include "host/physics/linear/contact_elements.hpp"
#include "host/physics/linear/world_reduce.hpp"
#include "solve/cg_world.h"

namespace pvg {

struct CgReport {
  std::vector<int> iterations;      // [n_worlds]
  std::vector<char> has_converged;  // [n_worlds]
};

// What a solve is of. Vectors are [n_nodes x 3].
struct CgOperators {
  // out = H direction, and out = M^-1 residual. Returns whether it left in chunks.partial() what direction . out, or
  // residual . out, is over each chunk of at most 64 nodes; if not, a launch of its own does.
  using Apply = std::function<bool(const Buffer<f64>& x, Buffer<f64>& out, WorldChunks& chunks)>;
  Apply product, precondition;
  // Elements whose rows of H direction are found before product() is called, in the launch that turns the direction.
  std::optional<ContactElements> elements;
};

class ConjugateGradients {
 public:
  ConjugateGradients(Device& device, const std::vector<u32>& node_world, std::size_t n_worlds,
                     const std::vector<WorldRange>& node_ranges);
  // Solves H dx = -gradient in the worlds that are active; dx = 0 in the others.
  // product(direction, out): out = H direction;  precondition(residual, out): out = M^-1 residual
  using Product = std::function<void(const Buffer<f64>&, Buffer<f64>&)>;
  CgReport solve(const Product& product, const Product& precondition, const Buffer<f64>& gradient,
                 const std::vector<char>& world_is_active, double tolerance, int max_iterations, Buffer<f64>& dx);

  // The same without waiting: starts some iterations and to read how far they came. After the device was waited for
  // ended() tells whether they were enough; go_on() starts more.
  void start(CgOperators operators, const Buffer<f64>& gradient, const std::vector<char>& world_is_active,
             double tolerance, int max_iterations, Buffer<f64>& dx, bool has_begun = false);
  // dx = 0 and this = -gradient are set already where has_begun
  Buffer<f64>& residual() { return residual_; }
  bool ended() const;
  void go_on();
  // as far as the last solve tells, without looking
  bool may_have_ended() const { return n_started_ >= n_last_; }
  bool is_short() const { return n_last_ <= SHORT; }
  // as far as the last two looks tell
  bool is_near_end() const { return is_near_end_; }
  void expect(int iterations) { n_last_ = iterations; }  // of the next solve, instead of those of the last one
  CgReport report();

 private:
  static constexpr int SHORT = 4;     // iterations, all of which are started before the host looks
  static constexpr int NEAR_END = 3;  // iterations that are foreseen from two looks mostly suffice
  int batch() const;
  int n_foreseen() const;
  // how a world's state is to be renewed when the direction turns, as in the kernels
  enum class When : u32 { as_it_is, at_start, after_iteration };
  struct Problem {
    CgOperators operators;
    double tolerance;
    int max_iterations;
    const Buffer<f64>* gradient;
    Buffer<f64>* dx;
  };
  u32 n_node_items() const { return u32(GROUP_SIZE * chunks_.n_chunks()); }
  void apply(const CgOperators::Apply& apply, const Buffer<f64>& x, Buffer<f64>& out);
  void precondition();  // z; r . z of small worlds is left to who needs it
  void turn();
  void advance();
  void test();

  Device* device_;
  std::size_t n_nodes_, n_worlds_;
  Program program_;
  Kernel start_, dot_, test_, test_residual_, turn_, advance_;
  WorldChunks chunks_;
  Buffer<u32> node_world_, is_wanted_;
  Buffer<CgWorld> worlds_, renewed_worlds_;
  Buffer<f64> residual_, preconditioned_, direction_, turned_direction_, product_;
  // where there are no elements
  Buffer<u32> no_indices_;
  Buffer<Site> no_sites_;
  Buffer<f64> no_numbers_, no_rows_;
  std::vector<char> wanted_;  // what is_wanted_ holds
  Problem problem_{};
  When when_ = When::at_start;
  std::vector<CgWorld> read_, read_before_;  // [n_worlds] as the device had them, and at the look before
  int n_started_ = 0, n_before_ = 0;         // iterations
  bool is_near_end_ = false;
  int n_last_ = 1;              // of the last solve
  bool has_rz_ = true;          // in chunks_.partial()
  bool z_is_old_ = false;       // the residual was tested instead
  bool residual_tells_ = true;  // that one iteration is enough, as in the last solve
};

}  // namespace pvg
