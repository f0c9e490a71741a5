#include "host/physics/linear/conjugate_gradients.hpp"

#include <algorithm>
#include <cmath>

namespace pvg {
namespace {
// |r| / |g| that ends a solve without a test in the preconditioner's norm: with an exact factor rounding is left, 1e-10
// and less. By judgement: the tolerances in that norm are 1e-4 and above 1e-8 of any scene.
constexpr double RESIDUAL = 1e-8;
}  // namespace

ConjugateGradients::ConjugateGradients(Device& device, const std::vector<u32>& node_world, std::size_t n_worlds,
                                       const std::vector<WorldRange>& node_ranges)
    : device_(&device),
      n_nodes_(node_world.size()),
      n_worlds_(n_worlds),
      program_(device, "solve/conjugate_gradients.cl"),
      start_(program_.kernel("cg_start")),
      begin_(program_.kernel("cg_begin")),
      test_(program_.kernel("cg_test")),
      test_residual_(program_.kernel("cg_test_residual")),
      step_length_(program_.kernel("cg_step_length")),
      advance_(program_.kernel("cg_advance")),
      turn_(program_.kernel("cg_turn")),
      reduce_(device, n_worlds),
      chunks_(device, n_worlds),
      node_world_(device, node_world, "world"),
      is_wanted_(device, n_worlds, "is_wanted"),
      worlds_(device, n_worlds, "worlds"),
      residual_(device, 3 * n_nodes_, "residual"),
      preconditioned_(device, 3 * n_nodes_, "preconditioned"),
      direction_(device, 3 * n_nodes_, "direction"),
      product_(device, 3 * n_nodes_, "product"),
      residual_partial_(device, 0, "partial") {
  chunks_.set(node_ranges);
  residual_partial_.resize(2 * chunks_.partial().size());
}

bool ConjugateGradients::renew_z() {
  problem_.precondition(residual_, preconditioned_);
  return reduce_.dot_chunks_of_large(chunks_, residual_, preconditioned_);
}

void ConjugateGradients::start(Product product, Product precondition, const Buffer<f64>& gradient,
                               const std::vector<char>& world_is_active, double tolerance, int max_iterations,
                               Buffer<f64>& dx) {
  const u32 n = u32(n_nodes_), n_items = u32(GROUP_SIZE * n_worlds_);
  problem_ = {std::move(product), std::move(precondition), tolerance, max_iterations, &gradient, &dx};
  if (wanted_ != world_is_active) {
    wanted_ = world_is_active;
    is_wanted_.write(std::vector<u32>(wanted_.begin(), wanted_.end()));
  }
  start_(n, n, gradient, dx, residual_);
  const bool has_partial = renew_z();
  begin_(n_items, n_items, u32(has_partial), chunks_.first(), chunks_.chunks(), residual_, preconditioned_,
         chunks_.partial(), is_wanted_, tolerance, u32(max_iterations), worlds_, u32(joins_launches()), direction_);
  n_started_ = 0;
  was_tested_ = true;
  read_.resize(n_worlds_);
  go_on();
}

// Whether the work-group of a world does what is to be done at its nodes besides: elsewhere than on the host's own
// processor a launch takes longer.
bool ConjugateGradients::joins_launches() const {
  return !device_->info().runs_host_functions && !chunks_.has_large_world();
}

void ConjugateGradients::test() {
  const u32 n_items = u32(GROUP_SIZE * n_worlds_);
  const bool has_partial = renew_z();
  test_(n_items, n_items, u32(has_partial), chunks_.first(), chunks_.chunks(), residual_, preconditioned_,
        chunks_.partial(), problem_.tolerance, u32(problem_.max_iterations), worlds_);
  was_tested_ = true;
}

// On the host's own processor it is cheap to look and dear to iterate in vain: half of what the last solve took, then a
// few at a time. Elsewhere it is the other way round, and where the last solve took one iteration the residual is
// tested first: to apply the preconditioner for a test takes more launches than all the rest.
void ConjugateGradients::go_on() {
  const bool looks_often = device_->info().runs_host_functions;
  const int batch =
      n_started_ == 0 ? (looks_often ? n_last_ / 2 : n_last_) : (looks_often ? n_started_ / 8 : n_started_ / 4);
  const u32 n = u32(n_nodes_), n_items = u32(GROUP_SIZE * n_worlds_);
  const bool tests_residual = !looks_often && n_started_ == 0 && n_last_ == 1 && residual_tells_;
  if (!was_tested_) {  // the residual was not enough
    residual_tells_ = false;
    test();
  }
  for (const int until = std::min(problem_.max_iterations, n_started_ + std::max(1, batch)); n_started_ < until;
       ++n_started_) {
    const bool joins = joins_launches();
    if (!(joins && n_started_ == 0)) turn_(n, n, node_world_, worlds_, preconditioned_, direction_);
    problem_.product(direction_, product_);
    const bool has_partial = reduce_.dot_chunks_of_large(chunks_, direction_, product_);
    step_length_(n_items, n_items, u32(has_partial), chunks_.first(), chunks_.chunks(), direction_, product_,
                 chunks_.partial(), worlds_, u32(joins), *problem_.dx, residual_);
    if (!joins) advance_(n, n, node_world_, worlds_, direction_, product_, *problem_.dx, residual_);
    if (!tests_residual) {
      test();
      continue;
    }
    test_residual_(n_items, n_items, chunks_.first(), chunks_.chunks(), residual_, *problem_.gradient,
                   residual_partial_, RESIDUAL, worlds_);
    was_tested_ = false;
  }
  worlds_.read_later(0, std::span(read_));
}

bool ConjugateGradients::ended() const {
  return n_started_ >= problem_.max_iterations ||
         std::none_of(read_.begin(), read_.end(), [](const CgWorld& world) { return world.is_active; });
}

CgReport ConjugateGradients::report() {
  CgReport report;
  for (const CgWorld& world : read_) {
    report.iterations.push_back(int(world.iterations));
    report.has_converged.push_back(world.has_converged && !world.is_active);
  }
  n_last_ = *std::max_element(report.iterations.begin(), report.iterations.end());
  return report;
}

CgReport ConjugateGradients::solve(const Product& product, const Product& precondition, const Buffer<f64>& gradient,
                                   const std::vector<char>& world_is_active, double tolerance, int max_iterations,
                                   Buffer<f64>& dx) {
  start(product, precondition, gradient, world_is_active, tolerance, max_iterations, dx);
  for (device_->finish(); !ended(); device_->finish()) go_on();
  return report();
}

}  // namespace pvg
