#include "host/physics/step/actuator.hpp"

#include <algorithm>
#include <cmath>

namespace pvg {

Actuators::Actuators(const PhysicalScene& scene, std::vector<double> start)
    : h_(scene.solver.time_step), start_(std::move(start)) {
  for (const Joint& joint : scene.joints) {
    if (!is_driven(joint)) continue;
    delay_.push_back(joint.drive.delay);
    time_constant_.push_back(joint.drive.time_constant);
    const std::size_t of_delay = joint.drive.delay > 0 ? std::size_t(std::ceil(joint.drive.delay / h_)) : 0;
    n_past_ = std::max(n_past_, of_delay + (joint.drive.time_constant > 0));
  }
  for (std::size_t k = 0; k < n_past_; ++k) past_.insert(past_.end(), start_.begin(), start_.end());
}

// targets are given at the ends of steps: `target` at this one's, past_ at those before
double Actuators::delayed(std::size_t drive, double target, std::size_t steps_ago) const {
  const double steps = delay_[drive] / h_ + double(steps_ago);
  const std::size_t whole = std::size_t(steps);
  const auto given = [&](std::size_t ago) { return ago == 0 ? target : past_[(ago - 1) * delay_.size() + drive]; };
  const double later = given(whole), share = steps - double(whole);
  return share > 0 ? later + share * (given(whole + 1) - later) : later;
}

std::vector<double> Actuators::command(const std::vector<double>& targets,
                                       const std::vector<double>& last_command) const {
  std::vector<double> commands = targets;
  for (std::size_t i = 0; i < commands.size(); ++i) {
    if (delay_[i] > 0) commands[i] = delayed(i, targets[i], 0);
    if (time_constant_[i] > 0) {
      const double before = delayed(i, targets[i], 1), behind = (commands[i] - before) * time_constant_[i] / h_;
      commands[i] += (last_command[i] - before + behind) * std::exp(-h_ / time_constant_[i]) - behind;
    }
  }
  return commands;
}

void Actuators::accept(const std::vector<double>& targets) {
  if (n_past_ == 0) return;
  past_.insert(past_.begin(), targets.begin(), targets.end());
  past_.resize(n_past_ * delay_.size());
}

bool Actuators::restore(const std::vector<double>& past) {
  if (past.size() != past_.size()) return false;
  past_ = past;
  return true;
}

}  // namespace pvg
