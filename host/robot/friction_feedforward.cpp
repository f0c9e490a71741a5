#include "host/robot/friction_feedforward.hpp"

#include <algorithm>
#include <cmath>

#include "host/model/effect_row.hpp"

namespace pvg {
namespace {

double friction(const JointNumbers& n, double v) {
  const double speed = std::abs(v), share = std::min(speed / n.velocity, 1.0);
  const double over = speed / n.stribeck_velocity;
  const double dry = (n.coulomb + n.extra * std::exp(-over * over)) * (2 - share) * share;
  return n.damping * v + std::copysign(dry, v);
}

}  // namespace

std::vector<double> friction_lead(const Joint& joint, std::span<const Effect> effects, double start,
                                  std::span<const double> q, double time_step) {
  std::vector<double> lead(q.size(), 0);
  if (joint.drive.mode != Drive::Mode::position || !(joint.drive.stiffness > 0)) return lead;
  JointNumbers numbers;
  for (const Effect& effect : effects)
    if (effect.target == joint.name) add_numbers(effect, numbers);
  numbers.damping += joint.damping;
  const bool damps_error = joint.drive.damped_rate == Drive::DampedRate::error;
  if (!damps_error) numbers.damping += joint.drive.damping;
  const double damping = damps_error ? joint.drive.damping / time_step : 0;
  double before = start, e = 0;
  for (std::size_t i = 0; i < q.size(); ++i) {
    e = (friction(numbers, (q[i] - before) / time_step) + damping * e) / (joint.drive.stiffness + damping);
    lead[i] = e;
    before = q[i];
  }
  return lead;
}

}  // namespace pvg
