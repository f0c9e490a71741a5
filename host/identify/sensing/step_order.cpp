#include "host/identify/sensing/step_order.hpp"

#include <algorithm>
#include <cmath>

namespace pvg::diagnose {

bool dissipates(const PhysicalScene& scene) {
  return std::any_of(scene.joints.begin(), scene.joints.end(), [](const Joint& joint) {
    return joint.damping > 0 || (is_driven(joint) && joint.drive.damping > 0);
  });
}

bool damps_rate_of_command(const PhysicalScene& scene) {
  return std::any_of(scene.joints.begin(), scene.joints.end(), [](const Joint& joint) {
    const Drive& drive = joint.drive;
    return is_driven(joint) && drive.damping > 0 && drive.mode == Drive::Mode::position &&
           drive.damped_rate != Drive::DampedRate::joint;
  });
}

int order_of_steps(const Variant& variant) {
  const bool is_second =
      variant.scene.solver.integrator == SolverSettings::Integrator::bdf2 && !damps_rate_of_command(variant.scene);
  return (is_second ? 2 : 1) + (variant.extrapolates ? 1 : 0);
}

double richardson_factor(int order) { return std::exp2(order) / (std::exp2(order) - 1); }

std::vector<Prediction> extrapolated(const std::vector<Prediction>& coarse, std::vector<Prediction> fine, int order) {
  const double k = richardson_factor(order);
  for (std::size_t i = 0; i < fine.size(); ++i) {
    fine[i].residual = coarse[i].residual + k * (fine[i].residual - coarse[i].residual);
    fine[i].succeeded = fine[i].succeeded && coarse[i].succeeded;
  }
  return fine;
}

}  // namespace pvg::diagnose
