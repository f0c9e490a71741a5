#include "host/physics/step/time_integration.hpp"

#include <algorithm>
#include <utility>

#include "host/physics/step/potential.hpp"

namespace pvg {

TimeIntegrator::TimeIntegrator(Device& device, const System& system)
    : n_(u32(system.n_nodes())),
      program_(device, "solve/nodes.cl"),
      begin_step_(program_.kernel("begin_step")),
      backward_difference_(program_.kernel("backward_difference")),
      end_step_(program_.kernel("end_step")),
      node_is_fixed_(device, system.node_is_fixed, "is_fixed"),
      gravity_(device, system.gravity, "gravity"),
      velocity_(device, system.v, "v"),
      position_before_(device, system.x, "x before"),
      velocity_before_(device, system.v, "v before"),
      velocity_two_before_(device, system.v, "v two before"),
      past_position_(device, system.x, "past x"),
      past_velocity_(device, system.v, "past v"),
      node_ranges_(system.node_ranges),
      length_before_(system.n_worlds(), 0) {}

double TimeIntegrator::begin_step(const Buffer<f64>& x, double h, SolverSettings::Integrator integrator, bool goes_on,
                                  const Buffer<Site>& sites, Positions& start, Positions& predicted) {
  const bool is_second_order = integrator == SolverSettings::Integrator::bdf2 && goes_on;
  if (is_second_order) {
    backward_difference_(n_, n_, x, position_before_, past_position_);
    backward_difference_(n_, n_, velocity_, velocity_before_, past_velocity_);
  }
  is_second_order_ = is_second_order;
  length_ = h;
  inertia_length_ = is_second_order ? 2 * h / 3 : h;
  const u32 n_sites = u32(sites.size()), n = std::max(n_, n_sites);
  begin_step_(n, n, n_, n_sites, sites, x, is_second_order ? past_position_ : x,
              is_second_order ? past_velocity_ : velocity_, gravity_, node_is_fixed_, inertia_length_, start.node,
              start.site, predicted.node, predicted.site);
  return inertia_length_;
}

void TimeIntegrator::accept(const Buffer<f64>& start, const Buffer<f64>& end, std::span<const char> stepped) {
  // worlds that did not step keep what they had
  struct Kept {
    Buffer<f64>* buffer;
    std::size_t first;
    std::vector<double> values;
  };
  std::vector<Kept> kept;
  for (const WorldRange& range : node_ranges_)
    if (!stepped[range.world])
      for (Buffer<f64>* buffer : {&position_before_, &velocity_two_before_, &velocity_before_, &velocity_})
        kept.push_back({buffer, 3 * range.begin, buffer->read(3 * range.begin, 3 * (range.end - range.begin))});
  std::swap(velocity_two_before_, velocity_before_);
  std::swap(velocity_before_, velocity_);  // all of velocity_ is written next
  end_step_(n_, n_, end, is_second_order_ ? past_position_ : start, start, inertia_length_, velocity_,
            position_before_);
  for (const Kept& k : kept) k.buffer->write(k.first, k.values);
  for (std::size_t w = 0; w < length_before_.size(); ++w)
    if (stepped[w]) length_before_[w] = length_;
}

std::vector<double> TimeIntegrator::velocities(std::span<const double> before, std::span<const double> start,
                                               std::span<const double> end) const {
  std::vector<double> v(end.size());
  for (std::size_t i = 0; i < v.size(); ++i) {
    const double from = is_second_order_ ? (4 * start[i] - before[i]) / 3 : start[i];
    v[i] = (end[i] - from) / inertia_length_;
  }
  return v;
}

void TimeIntegrator::change_velocity(std::size_t world, std::size_t first_node, std::span<const double> velocity,
                                     SolverSettings::Integrator integrator) {
  velocity_.write(3 * first_node, std::vector<double>(velocity.begin(), velocity.end()));
  if (integrator == SolverSettings::Integrator::bdf2) length_before_[world] = 0;
}

MotionHistory TimeIntegrator::history() const {
  return {velocity_.read(), position_before_.read(), velocity_before_.read(), velocity_two_before_.read(),
          length_before_};
}

void TimeIntegrator::restore(const MotionHistory& history) {
  velocity_.write(history.velocity);
  position_before_.write(history.position_before);
  velocity_before_.write(history.velocity_before);
  velocity_two_before_.write(history.velocity_two_before);
  length_before_ = history.length_before;
}

}  // namespace pvg
