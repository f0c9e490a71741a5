#include "host/physics/linear/conjugate_gradients.hpp"

#include <algorithm>
#include <cmath>

namespace pvg {

ConjugateGradients::ConjugateGradients(Device& device, const std::vector<u32>& node_world, std::size_t n_worlds,
                                       const std::vector<WorldRange>& node_ranges)
    : n_nodes_(node_world.size()),
      n_worlds_(n_worlds),
      program_(device, "solve/conjugate_gradients.cl"),
      start_(program_.kernel("cg_start")),
      advance_(program_.kernel("cg_advance")),
      turn_(program_.kernel("cg_turn")),
      reduce_(device, n_worlds),
      chunks_(device, n_worlds),
      node_world_(device, node_world, "world"),
      is_active_(device, n_worlds, "is_active"),
      residual_(device, 3 * n_nodes_, "residual"),
      preconditioned_(device, 3 * n_nodes_, "preconditioned"),
      direction_(device, 3 * n_nodes_, "direction"),
      product_(device, 3 * n_nodes_, "product"),
      rz_(device, n_worlds, "rz"),
      rz_old_(device, n_worlds, "rz_old"),
      php_(device, n_worlds, "php") {
  chunks_.set(node_ranges);
}

CgReport ConjugateGradients::solve(const Product& product, const Product& precondition, const Buffer<f64>& gradient,
                                   std::vector<char> world_is_active, double tolerance, int max_iterations,
                                   Buffer<f64>& dx) {
  CgReport report{std::vector<int>(n_worlds_, 0), std::vector<char>(n_worlds_, true)};
  const auto set_active = [&] { is_active_.write(std::vector<u32>(world_is_active.begin(), world_is_active.end())); };
  const auto renew_rz = [&] {
    precondition(residual_, preconditioned_);
    reduce_.dot(chunks_, residual_, preconditioned_, rz_);
  };
  const u32 n = u32(n_nodes_);
  start_(n, n, gradient, dx, residual_);
  rz_old_.zero();
  renew_rz();
  const std::vector<double> first = rz_.read();
  std::vector<double> rz = first;
  for (int iteration = 0; iteration < max_iterations; ++iteration) {
    for (std::size_t w = 0; w < n_worlds_; ++w) {
      // a world is done when the residual, measured in the preconditioner's norm, has fallen by the tolerance
      const bool is_done = rz[w] <= tolerance * tolerance * first[w];
      if (world_is_active[w] && (is_done || !std::isfinite(rz[w]))) {
        world_is_active[w] = false;
        report.has_converged[w] = is_done;
      }
      report.iterations[w] += world_is_active[w];
    }
    if (std::none_of(world_is_active.begin(), world_is_active.end(), [](char a) { return a; })) return report;
    set_active();
    turn_(n, n, node_world_, is_active_, rz_, rz_old_, preconditioned_, direction_);
    product(direction_, product_);
    reduce_.dot(chunks_, direction_, product_, php_);
    advance_(n, n, node_world_, is_active_, rz_, php_, direction_, product_, dx, residual_);
    rz_old_.copy_from(rz_);
    renew_rz();
    rz = rz_.read();
  }
  for (std::size_t w = 0; w < n_worlds_; ++w) report.has_converged[w] &= !world_is_active[w];
  return report;
}

}  // namespace pvg
