#include "pipeline/episode/success.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "host/base/names.hpp"
#include "host/geometry/nearest_point.hpp"

namespace pvg {
namespace {

using When = Condition::When;

Vec3 into_frame(const AffineMap& frame, const Vec3& point) {
  return frame.leftCols<3>().partialPivLu().solve(point - frame.col(3));
}

Vec3 out_of_frame(const AffineMap& frame, const Vec3& point) { return frame.leftCols<3>() * point + frame.col(3); }

// "42.0 mm", "5.7 degrees", "3"
std::string shown(const Condition& condition, double value) {
  switch (kind_of(condition).unit) {
    case QuantityKind::Unit::rad:
      return fmt::format("{:.1f} degrees", value * 180 / std::acos(-1.0));
    case QuantityKind::Unit::m:
      return fmt::format("{:.1f} mm", 1e3 * value);
    default:
      return fmt::format("{:.0f}", value);
  }
}

// "beaker: slip in hand"
std::string subject(const Condition& condition) {
  std::string name = kind_of(condition).name;
  std::replace(name.begin(), name.end(), '_', ' ');
  return condition.of + ": " + name;
}

std::string bounds(const Condition& condition) {
  std::string text;
  if (condition.at_least) text = "at least " + shown(condition, *condition.at_least);
  if (condition.at_most) text += (text.empty() ? "" : " and ") + ("at most " + shown(condition, *condition.at_most));
  return text;
}

// false for what is not a number
bool is_within(const Condition& condition, double value) {
  return (!condition.at_least || value >= *condition.at_least) && (!condition.at_most || value <= *condition.at_most) &&
         value == value;
}

std::string at_time(double seconds) { return fmt::format(" at {:.2f} s", seconds); }

}  // namespace

double Measured::operator[](const std::string& name) const {
  for (const Number& number : numbers)
    if (number.name == name) return number.value;
  throw std::out_of_range("nothing was measured as " + name);
}

std::vector<Hand> hands_of(const TaskScene& built) {
  std::vector<Hand> hands;
  for (const BuiltRobot& robot : built.robots) {
    Hand& hand = hands.emplace_back();
    hand.base = robot.gripper_base;
    hand.fingers = robot.rigid_fingers;
    for (const int soft : robot.soft_fingers) hand.fingers.push_back(int(built.scene.rigid_bodies.size()) + soft);
  }
  return hands;
}

std::vector<std::vector<Phase>> phases(const std::vector<MotionElement>& elements,
                                       const std::vector<int>& element_of_step, int n_robots) {
  std::vector<bool> is_holding(std::size_t(n_robots), false);
  std::vector<std::vector<Phase>> of_element(elements.size());  // of those that begin a group
  for (std::size_t first = 0, last; first < elements.size(); first = last) {
    last = first + 1;
    while (last < elements.size() && elements[last].is_with_previous) ++last;
    std::vector<bool> carries(std::size_t(n_robots), false), closes(carries);
    for (std::size_t i = first; i < last; ++i) {
      const auto robot = std::size_t(elements[i].robot);
      const GripChange grip = kind_of(elements[i]).grip;
      if (grip == GripChange::opens) is_holding[robot] = false;
      closes[robot] = grip == GripChange::closes;
      carries[robot] = grip == GripChange::carries;
    }
    for (std::size_t robot = 0; robot < is_holding.size(); ++robot) {
      of_element[first].push_back(!is_holding[robot] ? Phase::free : carries[robot] ? Phase::carrying : Phase::holding);
      if (closes[robot]) is_holding[robot] = true;
    }
  }
  std::vector<std::vector<Phase>> of_step;
  for (const int element : element_of_step) of_step.push_back(of_element.at(std::size_t(element)));
  return of_step;
}

SuccessMonitor::SuccessMonitor(const Task& task, const Scene& scene, std::span<const Hand> hands,
                               const SceneState& start)
    : scene_(scene),
      hands_(hands.begin(), hands.end()),
      carriage_(scene.soft_bodies.size(), -1),
      rest_(scene.soft_bodies.size()) {
  for (const Condition& condition : task.success) success_.push_back(watch(condition));
  for (const Condition& condition : task.failure) failure_.push_back(watch(condition));
  for (std::vector<Watched>* list : {&success_, &failure_})
    for (Watched& watched : *list)
      if (watched.body >= 0 && !watched.is_cloth)
        watched.start_height = start.rigid.at(std::size_t(watched.body))(2, 3);
  for (const Stitch& stitch : scene.stitches)
    if (stitch.soft >= 0) carriage_.at(std::size_t(stitch.soft)) = stitch.rigid;
  for (std::size_t i = 0; i < rest_.size(); ++i)
    if (carriage_[i] >= 0)
      for (const Vec3& x : start.soft.at(i))
        rest_[i].push_back(into_frame(start.rigid.at(std::size_t(carriage_[i])), x));
}

SuccessMonitor::Watched SuccessMonitor::watch(const Condition& condition) const {
  Watched watched;
  watched.condition = condition;
  const auto demand = [](int index, const std::string& name, const char* kind) {
    if (index < 0)
      throw UsageError(std::string("a condition names `") + name + "`, but the scene has no " + kind +
                       " of that name; correct the name");
    return index;
  };
  const QuantityKind& kind = kind_of(condition);
  if (kind.of == QuantityKind::Of::joint) {
    watched.joint = demand(index_named(scene_.joints, condition.of), condition.of, "joint");
    return watched;
  }
  const int cloth = index_named(scene_.cloths, condition.of);
  watched.is_cloth = cloth >= 0;
  watched.body =
      watched.is_cloth ? cloth : demand(index_named(scene_.rigid_bodies, condition.of), condition.of, "body");
  if (!condition.target.empty())
    watched.target = demand(index_named(scene_.rigid_bodies, condition.target), condition.target, "body");
  if ((kind.keys & POINT_KEYS) == POINT_KEYS) {
    const std::vector<Vec3>& points = scene_.cloths.at(std::size_t(demand(cloth, condition.of, "cloth"))).mesh.points;
    const bool is_edge = (kind.keys & EDGE_KEYS) == EDGE_KEYS;
    constexpr int SAMPLES = 21;  // along an edge
    for (int k = 0; k < (is_edge ? SAMPLES : 1); ++k) {
      const double s = double(k) / (SAMPLES - 1);
      const Vec3 a = is_edge ? Vec3((1 - s) * condition.first + s * condition.first_end) : condition.first;
      const Vec3 b = is_edge ? Vec3((1 - s) * condition.second + s * condition.second_end) : condition.second;
      watched.pairs.push_back({nearest_point(points, a), nearest_point(points, b)});
    }
  }
  return watched;
}

double SuccessMonitor::held(Watched& watched, const WorldState& state, std::span<const Phase>) const {
  const int n_rigid = int(scene_.rigid_bodies.size()), n_soft = int(scene_.soft_bodies.size());
  const int body = watched.is_cloth ? n_rigid + n_soft + watched.body : watched.body;
  std::vector<int> touching;
  for (const ContactForce& contact : state.contacts) {
    const int other = contact.first == body ? contact.second : contact.second == body ? contact.first : -1;
    const bool is_finger = std::any_of(hands_.begin(), hands_.end(), [&](const Hand& hand) {
      return std::find(hand.fingers.begin(), hand.fingers.end(), other) != hand.fingers.end();
    });
    if (is_finger && std::find(touching.begin(), touching.end(), other) == touching.end()) touching.push_back(other);
  }
  return double(touching.size());
}

double SuccessMonitor::moved_in_hand(Watched& watched, const WorldState& state, std::span<const Phase> phase) const {
  const std::size_t robot = std::size_t(watched.condition.robot);
  if (phase[robot] == Phase::free) {
    watched.held_at.reset();
    return 0;
  }
  const Vec3 origin = state.rigid[std::size_t(watched.body)].col(3);
  const Vec3 in_hand = into_frame(state.rigid.at(std::size_t(hands_[robot].base)), origin);
  if (!watched.held_at) watched.held_at = in_hand;
  return (in_hand - *watched.held_at).norm();
}

double SuccessMonitor::slip_in_hand(Watched& watched, const WorldState& state, std::span<const Phase> phase) const {
  if (phase[std::size_t(watched.condition.robot)] != Phase::carrying) {
    watched.patches.clear();
    watched.was_carrying = false;
    return 0;
  }
  const AffineMap& object = state.rigid[std::size_t(watched.body)];
  const int n_rigid = int(scene_.rigid_bodies.size()), n_soft = int(scene_.soft_bodies.size());
  if (!watched.was_carrying) {
    watched.was_carrying = true;
    for (const ContactForce& contact : state.contacts) {
      const int other = contact.first == watched.body    ? contact.second
                        : contact.second == watched.body ? contact.first
                                                         : -1;
      if (other < n_rigid || other >= n_rigid + n_soft) continue;  // a rigid body or a cloth
      const std::size_t soft = std::size_t(other - n_rigid);
      const std::size_t nearest = nearest_point(state.soft[soft], contact.point);
      Patch& patch = watched.patches[soft];
      if (std::find(patch.nodes.begin(), patch.nodes.end(), nearest) != patch.nodes.end()) continue;
      patch.nodes.push_back(nearest);
      patch.start.push_back(into_frame(object, state.soft[soft][nearest]));
    }
  }
  double slip = 0;
  for (const auto& [soft, patch] : watched.patches) {
    Vec3 sum = Vec3::Zero();
    for (std::size_t i = 0; i < patch.nodes.size(); ++i)
      sum += into_frame(object, state.soft[soft][patch.nodes[i]]) - patch.start[i];
    slip = std::max(slip, sum.norm() / double(patch.nodes.size()));
  }
  return slip;
}

double SuccessMonitor::lifted(Watched& watched, const WorldState& state, std::span<const Phase>) const {
  return object(watched, state)(2, 3) - watched.start_height;
}

double SuccessMonitor::height(Watched& watched, const WorldState& state, std::span<const Phase>) const {
  if (!watched.is_cloth) return object(watched, state)(2, 3);
  double highest = -std::numeric_limits<double>::infinity();
  for (const Vec3& point : state.cloth.at(std::size_t(watched.body))) highest = std::max(highest, point.z());
  return highest;
}

double SuccessMonitor::tilt(Watched& watched, const WorldState& state, std::span<const Phase>) const {
  return std::acos(std::clamp(object(watched, state).col(2).normalized().z(), -1.0, 1.0));
}

double SuccessMonitor::position_error(Watched& watched, const WorldState& state, std::span<const Phase>) const {
  const Condition& condition = watched.condition;
  const Vec3 goal = watched.target < 0
                        ? condition.target_position
                        : out_of_frame(state.rigid[std::size_t(watched.target)], condition.target_position);
  return (out_of_frame(object(watched, state), condition.point) - goal).norm();
}

double SuccessMonitor::joint_angle(Watched& watched, const WorldState& state, std::span<const Phase>) const {
  return state.joint_position.at(std::size_t(watched.joint));
}

double SuccessMonitor::corner_distance(Watched& watched, const WorldState& state, std::span<const Phase>) const {
  const std::vector<Vec3>& points = state.cloth.at(std::size_t(watched.body));
  double largest = 0;
  for (const auto& [a, b] : watched.pairs) {
    const double distance = (points[a] - points[b]).norm();
    largest = distance <= largest ? largest : distance;  // what is not a number is kept
  }
  return largest;
}

double SuccessMonitor::edge_distance(Watched& watched, const WorldState& state, std::span<const Phase> phase) const {
  return corner_distance(watched, state, phase);  // of more pairs
}

double SuccessMonitor::quantity(Watched& watched, const WorldState& state, std::span<const Phase> phase) const {
  using Measure = double (SuccessMonitor::*)(Watched&, const WorldState&, std::span<const Phase>) const;
#define PVG_MEASURE(name, unit, of, keys) &SuccessMonitor::name,
  static constexpr Measure MEASURES[] = {PVG_QUANTITIES(PVG_MEASURE)};
#undef PVG_MEASURE
  return (this->*MEASURES[std::size_t(watched.condition.quantity)])(watched, state, phase);
}

void SuccessMonitor::update(Watched& watched, const WorldState& state, std::span<const Phase> phase) const {
  const double value = quantity(watched, state, phase);
  watched.last = value;
  watched.largest = n_steps_ == 0 ? value : std::max(watched.largest, value);
  watched.smallest = n_steps_ == 0 ? value : std::min(watched.smallest, value);
  watched.is_number = watched.is_number && value == value;
  const bool holds = is_within(watched.condition, value);
  if (holds && !watched.first_time) watched.first_time = state.time;
  if (!holds && !watched.broken_at) watched.broken_at = state.time;
}

void SuccessMonitor::measure_deformation(const WorldState& state) {
  for (std::size_t i = 0; i < rest_.size(); ++i) {
    if (carriage_[i] < 0) continue;
    const AffineMap& map = state.rigid[std::size_t(carriage_[i])];
    for (std::size_t n = 0; n < rest_[i].size(); ++n)
      finger_deformation_ = std::max(finger_deformation_, (out_of_frame(map, rest_[i][n]) - state.soft[i][n]).norm());
  }
}

void SuccessMonitor::observe(const WorldState& state, std::span<const Phase> phase) {
  measure_deformation(state);
  for (std::vector<Watched>* list : {&success_, &failure_})
    for (Watched& watched : *list) update(watched, state, phase);
  ++n_steps_;
}

Measured SuccessMonitor::measured() const {
  Measured measured;
  measured.finger_deformation = finger_deformation_;
  for (const std::vector<Watched>* list : {&success_, &failure_})
    for (const Watched& watched : *list) {
      const Condition& condition = watched.condition;
      constexpr const char* ENDINGS[] = {"", "_m", "_rad"};  // by unit
      const QuantityKind& kind = kind_of(condition);
      std::string name = std::string(kind.name) + ENDINGS[std::size_t(kind.unit)];
      const bool is_taken = std::any_of(measured.numbers.begin(), measured.numbers.end(),
                                        [&](const Measured::Number& number) { return number.name == name; });
      if (is_taken) name = condition.of + "_" + name;
      // of some time what came nearest to holding, of always what came nearest to not
      const bool wants_more = condition.at_least.has_value() != (condition.when == When::always);
      const double value = condition.when == When::end ? watched.last : wants_more ? watched.largest : watched.smallest;
      measured.numbers.push_back({name, value});
    }
  return measured;
}

std::optional<std::string> SuccessMonitor::failure() const {
  for (const Watched& watched : failure_) {
    const Condition& condition = watched.condition;
    const bool holds = condition.when == When::end      ? is_within(condition, watched.last)
                       : condition.when == When::always ? !watched.broken_at
                                                        : bool(watched.first_time);
    const std::string sentence = subject(condition);
    if (!watched.is_number) return sentence + " is not a number";
    if (holds)
      return sentence + " is " + bounds(condition) +
             (condition.when == When::some_time ? at_time(*watched.first_time) : "");
  }
  for (const Watched& watched : success_) {
    const Condition& condition = watched.condition;
    const std::string sentence = subject(condition);
    const std::string wanted = ", wanted is " + bounds(condition);
    if (condition.when == When::end && !is_within(condition, watched.last))
      return sentence + " ends at " + shown(condition, watched.last) + wanted;
    if (condition.when == When::always && watched.broken_at)
      return sentence + " is between " + shown(condition, watched.smallest) + " and " +
             shown(condition, watched.largest) + wanted + " at all times";
    if (condition.when == When::some_time && !watched.first_time)
      return sentence + " is at " + (condition.at_most ? "least " : "most ") +
             shown(condition, condition.at_most ? watched.smallest : watched.largest) + wanted;
  }
  return std::nullopt;
}

}  // namespace pvg
