// Benchmark of the linear solver: preconditioners and products side by side on one system, that of the first Newton
// iteration of the step after a scene's last one, contacts and friction included.
#pragma once
#include "pipeline/bench/physics.hpp"

namespace pvg {

struct PreconditionerFigures {
  std::string name;
  double analyse_seconds = 0;                       // once for a pattern: orderings, clusters [s]
  double build_seconds = 0, build_cpu_seconds = 0;  // for new numbers [s]
  double apply_seconds = 0;                         // of one application [s]
  int iterations = 0;                               // of conjugate gradients, to the scene's tolerance
  double solve_seconds = 0, solve_cpu_seconds = 0;  // all iterations [s]
  double bytes = 0;                                 // of factors or inverses
};

struct ProductFigures {
  double assemble_seconds = 0;  // of the block matrix from the elements' blocks [s]
  double matrix_seconds = 0;    // of one product with it [s]
  double elements_seconds = 0;  // of one product with the elements' dense blocks and the gathering of their rows [s]
  double matrix_bytes = 0, element_bytes = 0;
};

struct SolverFigures {
  std::string scene;
  std::size_t unknowns = 0, contacts = 0;
  std::vector<PreconditionerFigures> preconditioners;
  ProductFigures product;
};

// Medians of `repeats`. Throws TryAgain where `stop` asks for it.
SolverFigures run_solver_benchmark(const PhysicsBenchmark& benchmark, const std::filesystem::path& data,
                                   const std::string& device, std::size_t repeats, const std::atomic<bool>& stop);

}  // namespace pvg
