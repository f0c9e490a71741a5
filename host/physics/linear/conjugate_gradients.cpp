#include "host/physics/linear/conjugate_gradients.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace pvg {
namespace {

// |r| / |g| that ends a solve without a test in the preconditioner's norm: with an exact factor rounding is left, 1e-10
// and less. By judgement: the tolerances in that norm are 1e-4 and above 1e-8 of any scene.
constexpr double RESIDUAL = 1e-8;

// of a world, up to which each of its work-groups finds r . z of all of them itself
constexpr std::size_t MOST_CHUNKS = 8;

u32 n_groups(u32 n) { return u32((n + GROUP_SIZE - 1) / GROUP_SIZE); }

}  // namespace

ConjugateGradients::ConjugateGradients(Device& device, const std::vector<u32>& node_world, std::size_t n_worlds,
                                       const std::vector<WorldRange>& node_ranges)
    : device_(&device),
      n_nodes_(node_world.size()),
      n_worlds_(n_worlds),
      program_(device, "solve/conjugate_gradients.cl"),
      start_(program_.kernel("cg_start")),
      dot_(program_.kernel("cg_dot")),
      test_(program_.kernel("cg_test")),
      test_residual_(program_.kernel("cg_test_residual")),
      turn_(program_.kernel("cg_turn")),
      advance_(program_.kernel("cg_advance")),
      chunks_(device, n_worlds, GROUP_SIZE),
      node_world_(device, node_world, "world"),
      is_wanted_(device, n_worlds, "is_wanted"),
      worlds_(device, n_worlds, "worlds"),
      renewed_worlds_(device, n_worlds, "renewed worlds"),
      residual_(device, 3 * n_nodes_, "residual"),
      preconditioned_(device, 3 * n_nodes_, "preconditioned"),
      direction_(device, 3 * n_nodes_, "direction"),
      turned_direction_(device, 3 * n_nodes_, "turned direction"),
      product_(device, 3 * n_nodes_, "product"),
      no_indices_(device, 0, "no indices"),
      no_sites_(device, 0, "no sites"),
      no_numbers_(device, 0, "no numbers"),
      no_rows_(device, 0, "no rows") {
  chunks_.set(node_ranges);
}

void ConjugateGradients::apply(const CgOperators::Apply& apply, const Buffer<f64>& x, Buffer<f64>& out) {
  const u32 n = n_node_items();
  if (!apply(x, out, chunks_)) dot_(n, n, chunks_.chunks(), x, out, chunks_.partial());
}

void ConjugateGradients::precondition() {
  has_rz_ = problem_.operators.precondition(residual_, preconditioned_, chunks_);
  if (has_rz_ || chunks_.most() <= MOST_CHUNKS) return;
  const u32 n = n_node_items();
  dot_(n, n, chunks_.chunks(), residual_, preconditioned_, chunks_.partial());
  has_rz_ = true;
}

void ConjugateGradients::start(CgOperators operators, const Buffer<f64>& gradient,
                               const std::vector<char>& world_is_active, double tolerance, int max_iterations,
                               Buffer<f64>& dx, bool has_begun) {
  const u32 n = u32(n_nodes_);
  problem_ = {std::move(operators), tolerance, max_iterations, &gradient, &dx};
  if (wanted_ != world_is_active) {
    wanted_ = world_is_active;
    is_wanted_.write(std::vector<u32>(wanted_.begin(), wanted_.end()));
  }
  if (!has_begun) start_(n, n, gradient, dx, residual_);
  precondition();
  when_ = When::at_start;
  n_started_ = n_before_ = 0;
  z_is_old_ = false;
  read_.resize(n_worlds_);
  go_on();
}

void ConjugateGradients::turn() {
  const u32 n_chunks = u32(chunks_.n_chunks());
  const auto& elements = problem_.operators.elements;
  const u32 n_first = elements ? elements->n_of(0) : 0, n_second = elements ? elements->n_of(1) : 0;
  const bool has_elements = n_first + n_second > 0;
  const u32 n = u32(GROUP_SIZE) * (n_chunks + n_groups(n_first) + n_groups(n_second));
  const auto blocks_of = [&](std::size_t term) -> const Buffer<f64>& {
    return has_elements && term < elements->terms.size() ? elements->terms[term]->blocks() : no_numbers_;
  };
  turn_(n, n, n_chunks, u32(when_), chunks_.first(), chunks_.chunks(), u32(has_rz_), chunks_.partial(), is_wanted_,
        problem_.tolerance, u32(problem_.max_iterations), worlds_, renewed_worlds_, residual_, preconditioned_,
        direction_, turned_direction_, n_first, n_second, node_world_,
        has_elements ? *elements->element_sites : no_indices_, has_elements ? *elements->sites : no_sites_,
        blocks_of(0), blocks_of(1), has_elements ? elements->first_row : 0, has_elements ? *elements->rows : no_rows_);
  std::swap(worlds_, renewed_worlds_);
  std::swap(direction_, turned_direction_);
}

void ConjugateGradients::advance() {
  const u32 n = n_node_items();
  advance_(n, n, chunks_.first(), chunks_.chunks(), chunks_.partial(), worlds_, direction_, product_, *problem_.dx,
           residual_);
}

void ConjugateGradients::test() {
  const u32 n = u32(GROUP_SIZE * n_worlds_);
  test_(n, n, u32(std::exchange(when_, When::as_it_is)), chunks_.first(), chunks_.chunks(), u32(has_rz_),
        chunks_.partial(), residual_, preconditioned_, is_wanted_, problem_.tolerance, u32(problem_.max_iterations),
        u32(!device_->info().runs_host_functions), *problem_.gradient, RESIDUAL, worlds_, renewed_worlds_);
  std::swap(worlds_, renewed_worlds_);
}

// Iterations that are left, if r . z goes on to fall as it did since the look before, or since the start.
int ConjugateGradients::n_foreseen() const {
  double most = 1;
  for (std::size_t w = 0; w < read_.size(); ++w) {
    const CgWorld& now = read_[w];
    const double before = n_before_ > 0 ? read_before_[w].rz : now.first_rz;
    const double fallen = std::log(before / now.rz) / (n_started_ - n_before_);
    const double left = std::log(now.rz / now.first_rz) - 2 * std::log(problem_.tolerance);
    if (now.is_active && fallen > 0) most = std::max(most, left / fallen);
  }
  return int(std::ceil(std::min(most, double(n_started_))));
}

// How many iterations to start before the host looks. On the host's own processor it is cheap to look and dear to
// iterate in vain: half of what the last solve took, then a few at a time. Elsewhere a look takes as long as two
// launches and an iteration six, but to go on after a short solve costs what was started behind it.
int ConjugateGradients::batch() const {
  const bool looks_often = device_->info().runs_host_functions;
  if (n_started_ > 0 && looks_often) return std::max(1, n_started_ / 8);
  if (n_started_ > 0) return n_started_ < SHORT ? 1 : n_foreseen();
  if (looks_often) return std::max(1, n_last_ / 2);
  return is_short() ? std::max(1, n_last_) : n_last_ * 3 / 4;
}

// Where the last solve took one iteration the residual is tested first, elsewhere than on the host's own processor: to
// apply the preconditioner for a test takes more launches than all the rest.
void ConjugateGradients::go_on() {
  const bool looks_often = device_->info().runs_host_functions;
  const bool tests_residual = !looks_often && n_started_ == 0 && n_last_ == 1 && residual_tells_;
  const auto renew_z = [&] {
    precondition();
    when_ = When::after_iteration;
  };
  const int n = batch();
  is_near_end_ = n_before_ > 0 && n <= NEAR_END;
  n_before_ = n_started_;
  read_before_ = read_;
  if (std::exchange(z_is_old_, false)) {  // the residual was not enough
    residual_tells_ = false;
    renew_z();
  }
  for (const int until = std::min(problem_.max_iterations, n_started_ + n); n_started_ < until; ++n_started_) {
    turn();
    apply(problem_.operators.product, direction_, product_);
    advance();
    if (!tests_residual) {
      renew_z();
      continue;
    }
    const u32 n = u32(GROUP_SIZE * n_worlds_);
    test_residual_(n, n, chunks_.first(), chunks_.chunks(), residual_, *problem_.gradient, RESIDUAL, worlds_);
    z_is_old_ = true;
  }
  if (!z_is_old_) test();
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
  if (!z_is_old_)  // else it told
    residual_tells_ =
        std::all_of(read_.begin(), read_.end(), [](const CgWorld& world) { return world.residual_tells; });
  return report;
}

CgReport ConjugateGradients::solve(const Product& product, const Product& precondition, const Buffer<f64>& gradient,
                                   const std::vector<char>& world_is_active, double tolerance, int max_iterations,
                                   Buffer<f64>& dx) {
  const auto without_sums = [](const Product& apply) {
    return [&apply](const Buffer<f64>& x, Buffer<f64>& out, WorldChunks&) {
      apply(x, out);
      return false;
    };
  };
  start({without_sums(product), without_sums(precondition), std::nullopt}, gradient, world_is_active, tolerance,
        max_iterations, dx);
  for (device_->finish(); !ended(); device_->finish()) go_on();
  return report();
}

}  // namespace pvg
