#include "host/physics/contact/continuous_collision.hpp"

namespace pvg {
namespace {
constexpr std::size_t N_LANES = GROUP_SIZE;  // as in solve/world_least.cl
}

WorldMinimum::WorldMinimum(Device& device)
    : program_(device, "contact/contact.cl"),
      min_of_worlds_(program_.kernel("min_of_worlds")),
      first_(device, 0, "first_of_world"),
      least_(device, 0, "world_minimum") {}

std::vector<double> WorldMinimum::operator()(const std::vector<u32>& first, const Buffer<double>& values, double none) {
  const std::size_t n_worlds = first.size() - 1;
  if (first.back() == 0) return std::vector<double>(n_worlds, none);
  first_.resize(first.size());
  first_.write(first);
  least_.resize(n_worlds);
  const std::size_t n_items = n_worlds * N_LANES;
  min_of_worlds_(n_items, u32(n_items), first_, values, none, least_);
  return least_.read();
}

ContinuousCollision::ContinuousCollision(Device& device)
    : program_(device, "contact/accd_steps.cl"),
      accd_steps_(program_.kernel("accd_steps")),
      steps_(device, 0, "certified_steps"),
      of_64_(device, 0, "least_of_64"),
      minimum_(device) {}

Buffer<double>& ContinuousCollision::steps(std::size_t n) {
  steps_.resize(n);
  of_64_.resize((n + GROUP_SIZE - 1) / GROUP_SIZE);
  return steps_;
}

const Buffer<double>& ContinuousCollision::start(const WorldRows<Barrier>& pairs, const Buffer<double>& x0,
                                                 const Buffer<double>& x1) {
  steps(pairs.n());
  accd_steps_(pairs.n(), pairs.n(), pairs.rows, x0, x1, steps_, of_64_);
  return steps_;
}

std::vector<double> ContinuousCollision::largest_step(const WorldRows<Barrier>& pairs, const Buffer<double>& x0,
                                                      const Buffer<double>& x1) {
  return minimum_(pairs.first, start(pairs, x0, x1), 1.0);
}

}  // namespace pvg
