#include "host/robot/path_planner.hpp"

#include <ompl/base/ScopedState.h>
#include <ompl/base/SpaceInformation.h>
#include <ompl/base/spaces/RealVectorStateSpace.h>
#include <ompl/geometric/PathGeometric.h>
#include <ompl/geometric/planners/rrt/RRTConnect.h>
#include <ompl/util/Console.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>
#include <set>

#include "host/robot/collision_part.hpp"
#include "host/robot/joint_path.hpp"

namespace pvg {
namespace {

namespace ob = ompl::base;
namespace og = ompl::geometric;

constexpr double RESOLUTION = 0.02;      // of a joint, between two checks of a motion [rad]
constexpr unsigned MOST_ROUNDS = 20000;  // of RRT-Connect
constexpr int SHORTCUTS = 200;
constexpr int MOST_KNOTS = 128;
constexpr std::uint64_t SEED = 1;

// our own, because OMPL's generators are seeded by how many there were before
class CountedSampler : public ob::StateSampler {
 public:
  explicit CountedSampler(const ob::StateSpace* space)
      : ob::StateSampler(space), bounds_(space->as<ob::RealVectorStateSpace>()->getBounds()), random_(SEED) {}
  void sampleUniform(ob::State* state) override {
    for (std::size_t i = 0; i < bounds_.low.size(); ++i)
      set(state, i, bounds_.low[i] + (bounds_.high[i] - bounds_.low[i]) * uniform());
  }
  void sampleUniformNear(ob::State* state, const ob::State* near, double distance) override {
    for (std::size_t i = 0; i < bounds_.low.size(); ++i)
      set(state, i, std::clamp(value(near, i) + distance * (2 * uniform() - 1), bounds_.low[i], bounds_.high[i]));
  }
  void sampleGaussian(ob::State* state, const ob::State* mean, double deviation) override {
    sampleUniformNear(state, mean, deviation);
  }

 private:
  static void set(ob::State* state, std::size_t i, double value) {
    state->as<ob::RealVectorStateSpace::StateType>()->values[i] = value;
  }
  static double value(const ob::State* state, std::size_t i) {
    return state->as<ob::RealVectorStateSpace::StateType>()->values[i];
  }
  double uniform() { return double(random_() >> 11) * 0x1p-53; }
  const ob::RealVectorBounds bounds_;
  std::mt19937_64 random_;
};

VectorXd configuration(const ob::State* state, Eigen::Index n) {
  return Eigen::Map<const VectorXd>(state->as<ob::RealVectorStateSpace::StateType>()->values, n);
}

}  // namespace

struct PathPlanner::Impl {
  RobotModel model;
  std::vector<CollisionPart> parts;
  std::vector<std::array<std::size_t, 2>> pairs;  // of parts that may collide
  double clearance = 0;
};

PathPlanner::PathPlanner(const RobotModel& model, int link, const std::vector<Obstacle>& carried,
                         const std::vector<Obstacle>& obstacles, double clearance)
    : impl_(std::make_unique<Impl>()) {
  impl_->model = model;
  impl_->clearance = clearance;
  std::vector<CollisionPart>& parts = impl_->parts;
  for (std::size_t i = 0; i < model.links.size(); ++i)
    if (!model.links[i].collision.triangles.empty())
      parts.push_back(make_collision_part(model.links[i].name, int(i), Pose::Identity(), model.links[i].collision));
  const std::size_t n_links = parts.size();
  for (const Obstacle& thing : carried) parts.push_back(make_collision_part(thing.name, link, thing.pose, thing.mesh));
  const std::size_t n_moving = parts.size();
  for (const Obstacle& thing : obstacles) parts.push_back(make_collision_part(thing.name, -1, thing.pose, thing.mesh));

  // what joints hold together, and what can never meet by the URDF, is left out; so is the wrist against what it
  // carries
  std::set<std::pair<int, int>> free_pairs;
  for (const RobotJoint& joint : model.joints) free_pairs.insert(std::minmax(joint.parent, joint.child));
  for (const auto& [a, b] : model.noncolliding) free_pairs.insert(std::minmax(a, b));
  std::set<int> wrist;
  for (int at = link, k = 0; at >= 0 && k < 4; ++k) {
    wrist.insert(at);
    at = at == 0 ? -1 : model.joints[std::size_t(at) - 1].parent;
  }
  for (std::size_t a = 0; a < n_moving; ++a)
    for (std::size_t b = a + 1; b < parts.size(); ++b) {
      const bool both_links = b < n_links, both_carried = a >= n_links && b < n_moving;
      if (both_links && free_pairs.contains(std::minmax(parts[a].link, parts[b].link))) continue;
      if (both_carried || (a < n_links && b >= n_links && b < n_moving && wrist.contains(parts[a].link))) continue;
      if (b >= n_moving && a < n_links && parts[a].link == 0) continue;  // the base stands where it stands
      impl_->pairs.push_back({a, b});
    }
}

PathPlanner::~PathPlanner() = default;
PathPlanner::PathPlanner(PathPlanner&&) noexcept = default;

std::optional<std::array<std::string, 2>> PathPlanner::collision(const VectorXd& q) const {
  const std::vector<Pose> links = link_poses(impl_->model, q);
  std::vector<Pose> poses;
  for (const CollisionPart& part : impl_->parts)
    poses.push_back(part.link < 0 ? part.pose : links[std::size_t(part.link)] * part.pose);
  for (const auto& [a, b] : impl_->pairs)
    if (are_closer(impl_->parts[a], poses[a], impl_->parts[b], poses[b], impl_->clearance))
      return {{impl_->parts[a].name, impl_->parts[b].name}};
  return std::nullopt;
}

namespace {

using IsFree = std::function<bool(const VectorXd& q)>;

bool is_straight_free(const IsFree& is_free, const VectorXd& a, const VectorXd& b) {
  const int checks = std::max(1, int(std::ceil((b - a).cwiseAbs().maxCoeff() / RESOLUTION)));
  for (int k = 1; k <= checks; ++k)
    if (!is_free(a + double(k) / checks * (b - a))) return false;
  return true;
}

// The joints' limits with a margin, widened to hold both ends of the path.
ob::RealVectorBounds bounds_of(const RobotModel& model, const VectorXd& from, const VectorXd& to) {
  constexpr double PI = std::numbers::pi, MARGIN = 0.02;
  ob::RealVectorBounds bounds{unsigned(from.size())};
  for (Eigen::Index i = 0; i < from.size(); ++i) {
    const RobotJoint& joint = model.joints[std::size_t(model.actuated[std::size_t(i)])];
    const bool has_ends = joint.lower != 0 || joint.upper != 0;
    bounds.setLow(unsigned(i), std::min({has_ends ? joint.lower + MARGIN : -PI, from[i], to[i]}));
    bounds.setHigh(unsigned(i), std::max({has_ends ? joint.upper - MARGIN : PI, from[i], to[i]}));
  }
  return bounds;
}

// Corners of a free path by RRT-Connect; none: it found none.
std::vector<VectorXd> searched_corners(const IsFree& is_free, const ob::RealVectorBounds& bounds, const VectorXd& from,
                                       const VectorXd& to) {
  const Eigen::Index n = from.size();
  ompl::msg::setLogLevel(ompl::msg::LOG_NONE);
  auto space = std::make_shared<ob::RealVectorStateSpace>(unsigned(n));
  space->setBounds(bounds);
  space->setStateSamplerAllocator([](const ob::StateSpace* s) { return std::make_shared<CountedSampler>(s); });
  auto information = std::make_shared<ob::SpaceInformation>(space);
  information->setStateValidityChecker([&](const ob::State* state) { return is_free(configuration(state, n)); });
  information->setStateValidityCheckingResolution(RESOLUTION / space->getMaximumExtent());
  information->setup();
  auto problem = std::make_shared<ob::ProblemDefinition>(information);
  ob::ScopedState<ob::RealVectorStateSpace> start(space), goal(space);
  for (unsigned i = 0; i < unsigned(n); ++i) start[i] = from[Eigen::Index(i)], goal[i] = to[Eigen::Index(i)];
  problem->setStartAndGoalStates(start, goal);
  og::RRTConnect planner(information);
  planner.setRange(0.5);
  planner.setProblemDefinition(problem);
  planner.setup();
  unsigned rounds = 0;
  const ob::PlannerTerminationCondition enough([&] { return ++rounds > MOST_ROUNDS; });
  std::vector<VectorXd> corners;
  if (planner.solve(enough) != ob::PlannerStatus::EXACT_SOLUTION) return corners;
  for (ob::State* state : problem->getSolutionPath()->as<og::PathGeometric>()->getStates())
    corners.push_back(configuration(state, n));
  return corners;
}

// Straight lines between corners that see each other.
void shorten(const IsFree& is_free, std::vector<VectorXd>& corners) {
  std::mt19937_64 random(SEED);
  for (int k = 0; k < SHORTCUTS && corners.size() > 2; ++k) {
    std::size_t a = random() % corners.size(), b = random() % corners.size();
    if (a > b) std::swap(a, b);
    if (b - a < 2 || !is_straight_free(is_free, corners[a], corners[b])) continue;
    corners.erase(corners.begin() + std::ptrdiff_t(a) + 1, corners.begin() + std::ptrdiff_t(b));
  }
}

bool is_path_free(const IsFree& is_free, const JointPath& path, double length) {
  const int checks = std::max(8, int(std::ceil(length / RESOLUTION)));
  for (int k = 0; k <= checks; ++k)
    if (!is_free(path.at(double(k) / checks).q)) return false;
  return true;
}

// Evenly spaced knots: few make a smooth path, which may cut a corner too much; then more.
std::optional<Eigen::MatrixXd> smooth_knots(const IsFree& is_free, const std::vector<VectorXd>& corners) {
  std::vector<double> length = {0};
  for (std::size_t i = 1; i < corners.size(); ++i)
    length.push_back(length.back() + (corners[i] - corners[i - 1]).norm());
  const auto on_corners = [&](double s) {
    const double at = s * length.back();
    std::size_t i = 1;
    while (i + 1 < corners.size() && length[i] < at) ++i;
    const double span = length[i] - length[i - 1];
    return VectorXd(corners[i - 1] + (span > 0 ? (at - length[i - 1]) / span : 1) * (corners[i] - corners[i - 1]));
  };
  for (int n_knots = corners.size() == 2 ? 2 : 8; n_knots <= MOST_KNOTS; n_knots *= 2) {
    Eigen::MatrixXd knots(n_knots, corners.front().size());
    for (int k = 0; k < n_knots; ++k) knots.row(k) = on_corners(double(k) / (n_knots - 1));
    if (is_path_free(is_free, JointPath(knots), length.back())) return knots;
  }
  return std::nullopt;
}

}  // namespace

std::optional<Eigen::MatrixXd> PathPlanner::plan(const VectorXd& from, const VectorXd& to) const {
  const IsFree is_free = [&](const VectorXd& q) { return !collision(q); };
  if (!is_free(from) || !is_free(to)) return std::nullopt;
  std::vector<VectorXd> corners = {from, to};
  if (!is_straight_free(is_free, from, to))
    corners = searched_corners(is_free, bounds_of(impl_->model, from, to), from, to);
  if (corners.empty()) return std::nullopt;
  shorten(is_free, corners);
  return smooth_knots(is_free, corners);
}

}  // namespace pvg
