#include "pipeline/success.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

namespace pvg {
namespace {

int body_named(const Scene& scene, const std::string& name, const char* key) {
  for (std::size_t i = 0; i < scene.rigid_bodies.size(); ++i)
    if (scene.rigid_bodies[i].name == name) return int(i);
  throw UsageError(std::string("success/") + key + ": the scene has no body named '" + name + "'");
}

Vec3 into_frame(const AffineMap& frame, const Vec3& point) {
  return frame.leftCols<3>().partialPivLu().solve(point - frame.col(3));
}

std::string format(const char* pattern, double a, double b) {
  char text[160];
  std::snprintf(text, sizeof text, pattern, a, b);
  return text;
}

}  // namespace

std::vector<Phase> phases(const std::vector<MotionElement>& elements, const std::vector<int>& element_of_step) {
  using Type = MotionElement::Type;
  std::vector<Phase> of_element;
  bool is_holding = false;
  for (const MotionElement& element : elements) {
    if (element.type == Type::open) is_holding = false;
    of_element.push_back(!is_holding ? Phase::free : element.type == Type::carry ? Phase::carrying : Phase::holding);
    if (element.type == Type::close) is_holding = true;
  }
  std::vector<Phase> of_step;
  for (const int element : element_of_step) of_step.push_back(of_element.at(std::size_t(element)));
  return of_step;
}

SuccessMonitor::SuccessMonitor(const SuccessConditions& conditions, const Scene& scene, int tool,
                               const SceneState& start)
    : conditions_(conditions),
      scene_(scene),
      object_(body_named(scene, conditions.object, "object")),
      target_(conditions.target.empty() ? -1 : body_named(scene, conditions.target, "target")),
      tool_(tool),
      start_height_(start.rigid.at(std::size_t(object_))(2, 3)),
      carriage_(scene.soft_bodies.size(), -1),
      rest_(scene.soft_bodies.size()) {
  for (const Stitch& stitch : scene.stitches)
    if (stitch.soft >= 0) carriage_.at(std::size_t(stitch.soft)) = stitch.rigid;
  for (std::size_t i = 0; i < rest_.size(); ++i)
    if (carriage_[i] >= 0)
      for (const Vec3& x : start.soft.at(i))
        rest_[i].push_back(into_frame(start.rigid.at(std::size_t(carriage_[i])), x));
}

void SuccessMonitor::measure_deformation(const WorldState& state) {
  for (std::size_t i = 0; i < rest_.size(); ++i) {
    if (carriage_[i] < 0) continue;
    const AffineMap& map = state.rigid[std::size_t(carriage_[i])];
    for (std::size_t n = 0; n < rest_[i].size(); ++n) {
      const double moved = (map.leftCols<3>() * rest_[i][n] + map.col(3) - state.soft[i][n]).norm();
      measured_.finger_deformation = std::max(measured_.finger_deformation, moved);
    }
  }
}

void SuccessMonitor::start_patches(const WorldState& state) {
  const int n_rigid = int(scene_.rigid_bodies.size()), n_soft = int(scene_.soft_bodies.size());
  patches_.clear();
  for (const ContactForce& contact : state.contacts) {
    const int other = contact.first == object_ ? contact.second : contact.second == object_ ? contact.first : -1;
    if (other < n_rigid || other >= n_rigid + n_soft) continue;  // a rigid body or a cloth
    const std::size_t soft = std::size_t(other - n_rigid);
    std::size_t nearest = 0;
    for (std::size_t n = 1; n < state.soft[soft].size(); ++n)
      if ((state.soft[soft][n] - contact.point).squaredNorm() <
          (state.soft[soft][nearest] - contact.point).squaredNorm())
        nearest = n;
    Patch& patch = patches_[soft];
    if (std::find(patch.nodes.begin(), patch.nodes.end(), nearest) != patch.nodes.end()) continue;
    patch.nodes.push_back(nearest);
    patch.start.push_back(into_frame(state.rigid[std::size_t(object_)], state.soft[soft][nearest]));
  }
}

void SuccessMonitor::observe(const WorldState& state, Phase phase) {
  const AffineMap& object = state.rigid.at(std::size_t(object_));
  const Vec3 origin = object.col(3);
  measured_.lifted = std::max(measured_.lifted, origin.z() - start_height_);
  measure_deformation(state);

  if (phase == Phase::free) {
    held_at_.reset();
    patches_.clear();
    has_carried_ = false;
  } else {
    const Vec3 in_hand = into_frame(state.rigid.at(std::size_t(tool_)), origin);
    if (!held_at_) held_at_ = in_hand;
    const double moved = (in_hand - *held_at_).norm();
    measured_.moved_in_hand = std::max(measured_.moved_in_hand, moved);
    if (moved > conditions_.slip_tolerance && !dropped_at_) dropped_at_ = state.time;
  }
  if (phase == Phase::carrying) {
    if (!has_carried_) start_patches(state);
    has_carried_ = true;
    for (const auto& [soft, patch] : patches_) {
      Vec3 sum = Vec3::Zero();
      for (std::size_t i = 0; i < patch.nodes.size(); ++i)
        sum += into_frame(object, state.soft[soft][patch.nodes[i]]) - patch.start[i];
      measured_.slip_in_hand = std::max(measured_.slip_in_hand, sum.norm() / double(patch.nodes.size()));
    }
  }

  // the end is whatever step comes last
  const Vec3 up = object.col(2).normalized();
  measured_.tilt = std::acos(std::clamp(up.z(), -1.0, 1.0));
  const Vec3 goal = target_ < 0 ? conditions_.target_position
                                : Vec3(state.rigid[std::size_t(target_)].leftCols<3>() * conditions_.target_position +
                                       state.rigid[std::size_t(target_)].col(3));
  measured_.position_error = (origin - goal).norm();
  const int n_rigid = int(scene_.rigid_bodies.size());
  measured_.is_held = std::any_of(state.contacts.begin(), state.contacts.end(), [&](const ContactForce& contact) {
    const int other = contact.first == object_ ? contact.second : contact.second == object_ ? contact.first : -1;
    return other >= n_rigid && other < n_rigid + int(scene_.soft_bodies.size());
  });
}

std::optional<std::string> SuccessMonitor::failure() const {
  const std::string& name = conditions_.object;
  const double degree = std::acos(-1.0) / 180;
  if (!(measured_.lifted >= conditions_.lifted))
    return name + format(" was lifted %.1f mm, not %.1f mm", 1e3 * measured_.lifted, 1e3 * conditions_.lifted);
  if (dropped_at_)
    return name +
           format(" moved more than %.1f mm in the hand at %.2f s", 1e3 * conditions_.slip_tolerance, *dropped_at_);
  if (measured_.is_held) return name + " is still held at the end";
  if (!(measured_.tilt <= conditions_.tilt_tolerance))
    return name + format(" ends tilted by %.1f degrees, allowed are %.1f", measured_.tilt / degree,
                         conditions_.tilt_tolerance / degree);
  if (!(measured_.position_error <= conditions_.position_tolerance))
    return name + format(" ends %.1f mm from its target, allowed are %.1f mm", 1e3 * measured_.position_error,
                         1e3 * conditions_.position_tolerance);
  return std::nullopt;
}

}  // namespace pvg
