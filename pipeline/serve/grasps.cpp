#include "pipeline/serve/grasps.hpp"

#include <algorithm>
#include <cmath>

namespace pvg {
namespace {

constexpr double NARROWER = 1e-3;  // than at the start, of a gripper that holds [m]
constexpr double AT_REST = 5e-3;   // speed of its width below which a gripper has closed [m/s]
constexpr double SLIPPED = 1e-2;   // way of an object's origin in the hand that holds it [m]
constexpr double FELL = 1e-2;      // height that an object loses which was let go of in the air [m]

bool holds(const std::vector<int>& list, int value) { return std::find(list.begin(), list.end(), value) != list.end(); }

bool is_rigid(int body, const WorldState& state) { return std::size_t(body) < state.rigid.size(); }

std::string body_name(const Scene& scene, std::size_t body) {
  const std::size_t n_rigid = scene.rigid_bodies.size(), n_soft = scene.soft_bodies.size();
  if (body < n_rigid) return scene.rigid_bodies[body].name;
  if (body < n_rigid + n_soft) return scene.soft_bodies[body - n_rigid].name;
  return scene.cloths.at(body - n_rigid - n_soft).name;
}

}  // namespace

Grasps::Grasps(const TaskScene& built) : built_(built), hands_(hands_of(built)) {
  const Scene& scene = built.scene;
  const std::size_t n_rigid = scene.rigid_bodies.size();
  const std::size_t n = n_rigid + scene.soft_bodies.size() + scene.cloths.size();
  is_robot_.assign(n, false);
  is_finger_.assign(n, false);
  can_move_.assign(n, true);
  for (const BuiltRobot& robot : built.robots)
    for (const std::vector<int>* bodies : {&robot.arm_bodies, &robot.gripper_bodies})
      for (const int body : *bodies) is_robot_[std::size_t(body)] = true;
  for (const Hand& hand : hands_)
    for (const int finger : hand.fingers) is_robot_[std::size_t(finger)] = is_finger_[std::size_t(finger)] = true;
  for (std::size_t i = 0; i < n; ++i) can_move_[i] = !is_robot_[i] && (i >= n_rigid || !scene.rigid_bodies[i].is_fixed);
  held_.assign(hands_.size(), -1);
  held_at_.assign(hands_.size(), std::nullopt);
  falling_.assign(hands_.size(), std::nullopt);
  phase_.assign(hands_.size(), Phase::free);
  for (const BuiltRobot& robot : built.robots) {
    double sum = 0;
    for (const int joint : robot.gripper) sum += scene.joints[std::size_t(joint)].initial;
    width_at_start_.push_back(sum);
  }
  width_before_ = width_at_start_;
}

double Grasps::width(std::size_t robot, const WorldState& state) const {
  double sum = 0;
  for (const int joint : built_.robots[robot].gripper) sum += state.joint_position[std::size_t(joint)];
  return sum;
}

int Grasps::held_by(std::size_t robot, const Touching& touching) const {
  const std::vector<int>& fingers = hands_[robot].fingers;
  const std::size_t enough = std::min<std::size_t>(2, fingers.size());
  if (enough == 0) return -1;
  for (std::size_t body = 0; body < touching.size(); ++body) {
    if (!can_move_[body]) continue;
    const auto n = std::count_if(fingers.begin(), fingers.end(), [&](int f) { return holds(touching[body], f); });
    if (std::size_t(n) >= enough) return int(body);
  }
  return -1;
}

void Grasps::add(const std::string& name, const std::string& of, double time) {
  if (known_.insert({name, of}).second) events_.push_back({name, of, time});
}

void Grasps::observe_fall(std::size_t robot, const WorldState& state, const Touching& touching) {
  if (!falling_[robot]) return;
  const auto body = std::size_t(falling_[robot]->body);
  if (falling_[robot]->height - state.rigid[body](2, 3) > FELL) {
    add("dropped", body_name(built_.scene, body), state.time);
    falling_[robot].reset();
  } else if (!touched_by_hand_alone(robot, touching[body])) {
    falling_[robot].reset();  // it was put down
  }
}

bool Grasps::touched_by_hand_alone(std::size_t robot, const std::vector<int>& others) const {
  return std::all_of(others.begin(), others.end(), [&](int other) { return holds(hands_[robot].fingers, other); });
}

void Grasps::observe_hand(std::size_t robot, const WorldState& state, const Touching& touching) {
  const double now = width(robot, state), length = state.time - time_before_;
  const bool rests = std::abs(now - width_before_[robot]) <= AT_REST * length;
  const bool is_closed = now < width_at_start_[robot] - NARROWER;
  width_before_[robot] = now;
  const int body = held_by(robot, touching);
  const bool goes_on = body >= 0 && body == held_[robot];
  const bool begins = body >= 0 && !goes_on && is_closed && rests;
  if (held_[robot] >= 0 && !goes_on && phase_[robot] == Phase::carrying && is_rigid(held_[robot], state))
    falling_[robot] = Falling{held_[robot], state.rigid[std::size_t(held_[robot])](2, 3)};
  observe_fall(robot, state, touching);
  held_[robot] = goes_on || begins ? body : -1;
  if (held_[robot] < 0) {
    held_at_[robot].reset();
    phase_[robot] = Phase::free;
    return;
  }
  falling_[robot].reset();
  const auto held = std::size_t(body);
  const std::string name = body_name(built_.scene, held);
  const bool is_alone = touched_by_hand_alone(robot, touching[held]);
  phase_[robot] = is_alone ? Phase::carrying : Phase::holding;
  add("grasped", name, state.time);
  if (is_alone) add("carried", name, state.time);
  if (!is_rigid(body, state)) return;
  const AffineMap& hand = state.rigid[std::size_t(hands_[robot].base)];
  const Vec3 in_hand = hand.leftCols<3>().partialPivLu().solve(state.rigid[held].col(3) - hand.col(3));
  if (!held_at_[robot]) held_at_[robot] = in_hand;
  if ((in_hand - *held_at_[robot]).norm() > SLIPPED) add("slipped", name, state.time);
}

void Grasps::observe_accidents(const WorldState& state, const Touching& touching) {
  for (std::size_t body = 0; body < touching.size(); ++body) {
    if (is_robot_[body]) continue;
    const bool is_bumped = std::any_of(touching[body].begin(), touching[body].end(), [&](int other) {
      return is_robot_[std::size_t(other)] && !is_finger_[std::size_t(other)];
    });
    if (is_bumped) add("bumped", body_name(built_.scene, body), state.time);
  }
  for (const BuiltRobot& robot : built_.robots)
    for (const int joint : robot.arm)
      if (state.joint_stop_effort.at(std::size_t(joint)) != 0)
        add("at_stop", built_.scene.joints[std::size_t(joint)].name, state.time);
}

void Grasps::observe(const WorldState& state) {
  Touching touching(is_robot_.size());
  for (const ContactForce& contact : state.contacts) {
    if (contact.first < 0 || contact.second < 0) continue;
    const auto put = [&](int body, int other) {
      if (!holds(touching[std::size_t(body)], other)) touching[std::size_t(body)].push_back(other);
    };
    put(contact.first, contact.second);
    put(contact.second, contact.first);
  }
  for (std::size_t robot = 0; robot < hands_.size(); ++robot) observe_hand(robot, state, touching);
  observe_accidents(state, touching);
  time_before_ = state.time;
}

}  // namespace pvg
