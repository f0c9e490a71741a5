#include "pipeline/episode/force_grasp.hpp"

#include <algorithm>
#include <cmath>

namespace pvg {
namespace {

constexpr double KEPT_SPEED = 0.5;  // share of its speed that a gripper keeps per step after the force was reached

// mean of what the drives exert toward closing [N]
double force_of(const std::vector<int>& joints, const WorldState& state) {
  double sum = 0;
  for (const int joint : joints) sum -= state.joint_effort.at(std::size_t(joint));
  return joints.empty() ? 0 : sum / double(joints.size());
}

}  // namespace

ForceGrasp::ForceGrasp(const MotionPlan& plan) : plan_(plan), grippers_(plan.gripper_columns.size()) {
  // where the first grip begins; without one the gripper stands where the first target says
  for (std::size_t r = 0; r < grippers_.size(); ++r) {
    const auto first =
        std::find_if(plan.grips.begin(), plan.grips.end(), [&](const Grip& g) { return g.robot == int(r); });
    if (first != plan.grips.end())
      grippers_[r].position = first->from;
    else if (!plan.gripper_columns[r].empty() && !plan.targets.empty())
      grippers_[r].position = plan.targets.front()[std::size_t(plan.gripper_columns[r].front())];
  }
}

std::vector<double> ForceGrasp::target(std::size_t step, const WorldState& state) {
  std::vector<double> target = plan_.targets.at(step);
  for (const Grip& grip : plan_.grips) {
    if (step < grip.first || step >= grip.last) continue;
    Gripper& gripper = grippers_[std::size_t(grip.robot)];
    const std::vector<int>& columns = plan_.gripper_columns[std::size_t(grip.robot)];
    if (columns.empty()) continue;
    if (step == grip.first) {
      gripper.start = gripper.position;
      gripper.velocity = 0;
      gripper.has_stopped = false;
    }
    gripper.has_stopped =
        gripper.has_stopped ||
        (grip.force > 0 && force_of(plan_.gripper_joints[std::size_t(grip.robot)], state) >= grip.force);
    const double before = gripper.position;
    if (gripper.has_stopped) {
      gripper.velocity *= KEPT_SPEED;
      gripper.position += gripper.velocity;
    } else {
      const double planned = target[std::size_t(columns.front())], way = grip.to - grip.from;
      const double share = way == 0 ? 1 : (planned - grip.from) / way;
      gripper.position = gripper.start + share * (grip.to - gripper.start);
      gripper.velocity = gripper.position - before;
    }
  }
  for (std::size_t r = 0; r < grippers_.size(); ++r)
    for (const int column : plan_.gripper_columns[r]) target[std::size_t(column)] = grippers_[r].position;
  return target;
}

}  // namespace pvg
