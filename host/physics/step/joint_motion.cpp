#include "host/physics/step/joint_motion.hpp"

namespace pvg {

std::vector<JointMotion> initial_motion(const PhysicalScene& scene) {
  std::vector<JointMotion> motion;
  for (const Joint& joint : scene.joints) {
    const RigidBody& parent = scene.rigid_bodies[std::size_t(joint.parent)];
    const RigidBody& child = scene.rigid_bodies[std::size_t(joint.child)];
    const Vec3 axis = parent.pose.linear() * (joint.parent_frame.linear() * joint.axis);
    const Vec3 on_parent = parent.pose * joint.parent_frame.translation() - parent.pose.translation();
    const Vec3 on_child = child.pose * joint.child_frame.translation() - child.pose.translation();
    double rate = 0;
    if (joint.type == Joint::Type::revolute) rate = axis.dot(child.angular_velocity - parent.angular_velocity);
    if (joint.type == Joint::Type::prismatic) {
      const Vec3 apart = child.pose.translation() + on_child - parent.pose.translation() - on_parent;
      const Vec3 of_parent = parent.velocity + parent.angular_velocity.cross(on_parent + apart);
      rate = axis.dot(child.velocity + child.angular_velocity.cross(on_child) - of_parent);
    }
    motion.push_back({joint.initial, rate, rate});
  }
  return motion;
}

double past_coordinate(const JointMotion& motion, double q, bool is_second_order) {
  return is_second_order ? (4 * q - motion.before) / 3 : q;
}

double rate_lead(const JointMotion& motion, double q, bool is_second_order) {
  return past_coordinate(motion, q, is_second_order) - q;
}

double foreseen_change(const JointMotion& motion, double q, bool is_second_order, double inertia_h) {
  const double rate = is_second_order ? (4 * motion.rate - motion.rate_before) / 3 : motion.rate;
  return past_coordinate(motion, q, is_second_order) - q + inertia_h * rate;
}

JointMotion after_step(const JointMotion& motion, double q_start, double q_end, bool is_second_order,
                       double inertia_h) {
  return {q_start, (q_end - past_coordinate(motion, q_start, is_second_order)) / inertia_h, motion.rate,
          motion.target_change};
}

std::vector<double> to_numbers(const std::vector<JointMotion>& motion) {
  std::vector<double> numbers;
  for (const JointMotion& m : motion) numbers.insert(numbers.end(), {m.before, m.rate, m.rate_before, m.target_change});
  return numbers;
}

std::vector<JointMotion> to_motion(const std::vector<double>& numbers) {
  std::vector<JointMotion> motion(numbers.size() / 4);
  for (std::size_t j = 0; j < motion.size(); ++j)
    motion[j] = {numbers[4 * j], numbers[4 * j + 1], numbers[4 * j + 2], numbers[4 * j + 3]};
  return motion;
}

}  // namespace pvg
