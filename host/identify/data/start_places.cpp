#include "host/identify/data/start_places.hpp"

#include <algorithm>
#include <cmath>

#include "host/identify/channels/resolve.hpp"
#include "host/identify/criteria.hpp"
#include "host/identify/data/window.hpp"

namespace pvg::diagnose {
namespace {

using Eigen::MatrixXd, Eigen::VectorXd;

constexpr int MOST_STEPS = 30;
constexpr double DIFFERENCE = 1e-6, SMALL_STEP = 1e-9;  // [rad, m], [rad/s, m/s]

bool is_measured_itself(const Problem& problem, int joint) {
  return std::any_of(problem.channels.begin(), problem.channels.end(), [&](const Channel& c) {
    return c.joint == joint && (c.sensor->start == StartRole::place || c.sensor->start == StartRole::rate);
  });
}

// The joints between a body and what does not move, from the body on.
std::vector<int> chain_of(const Problem& problem, int rigid) {
  std::vector<int> chain;
  for (auto j = problem.coordinates.rbegin(); j != problem.coordinates.rend(); ++j)
    if (const Joint& joint = problem.scene.scene.joints[std::size_t(*j)]; joint.child == rigid) {
      chain.push_back(*j);
      rigid = joint.parent;
    }
  return chain;
}

double usual_sigma(const PhysicalScene& scene, int joint) {
  return scene.joints[std::size_t(joint)].type == Joint::Type::revolute ? criteria().start_unmeasured_turn
                                                                        : criteria().start_unmeasured_shift;
}

// Coordinates, then rates of the joints at a start.
VectorXd numbers_of(const InitialState& start, const std::vector<int>& joints) {
  const Eigen::Index n = Eigen::Index(joints.size());
  VectorXd x(2 * n);
  for (Eigen::Index i = 0; i < n; ++i) {
    x[i] = start.position[std::size_t(joints[std::size_t(i)])];
    x[n + i] = start.rate[std::size_t(joints[std::size_t(i)])];
  }
  return x;
}

}  // namespace

bool is_place_of_body(const Channel& channel) {
  return channel.rigid >= 0 && channel.sensor->start == StartRole::place;
}

bool is_point_of_body(const Channel& channel) {
  return channel.rigid >= 0 && channel.sensor->kind == ChannelKind::marker;
}

std::vector<int> joints_seen_by_places(const Problem& problem) {
  std::vector<int> joints;
  for (const int j : problem.coordinates) {
    if (!has_coordinate(problem.scene.scene.joints[std::size_t(j)]) || is_measured_itself(problem, j)) continue;
    const bool is_seen = std::any_of(problem.channels.begin(), problem.channels.end(), [&](const Channel& channel) {
      if (!is_place_of_body(channel) && !is_point_of_body(channel)) return false;
      const std::vector<int> chain = chain_of(problem, channel.rigid);
      return std::find(chain.begin(), chain.end(), j) != chain.end();
    });
    if (is_seen) joints.push_back(j);
  }
  return joints;
}

std::vector<JointStart> joints_from_places(const Problem& problem, const Run& run, const InitialState& start,
                                           const std::vector<int>& joints, const std::vector<MeasuredPlace>& places) {
  if (joints.empty() || places.empty()) return {};
  const Eigen::Index n = Eigen::Index(joints.size()), n_places = Eigen::Index(places.size());
  PhysicalScene scene = scene_of(problem, run);
  const VectorXd usual = numbers_of(start, joints);
  VectorXd sigma(2 * n);
  for (Eigen::Index i = 0; i < n; ++i) {
    sigma[i] = usual_sigma(scene, joints[std::size_t(i)]);
    sigma[n + i] = criteria().start_unmeasured_rate * sigma[i];
  }
  // places, rates, and how far the numbers are from usual, each over its standard deviation
  const auto residual_at = [&](const VectorXd& x) {
    InitialState state = start;
    for (Eigen::Index i = 0; i < n; ++i) {
      state.position[std::size_t(joints[std::size_t(i)])] = x[i];
      state.rate[std::size_t(joints[std::size_t(i)])] = x[n + i];
    }
    start_at(problem, state, scene);
    VectorXd r(2 * n_places + 2 * n);
    for (Eigen::Index i = 0; i < n_places; ++i) {
      const MeasuredPlace& place = places[std::size_t(i)];
      const RigidBody& body = scene.rigid_bodies[std::size_t(place.rigid)];
      const Vec3 arm = body.pose.linear() * place.point;
      r[i] = (place.direction.dot(body.pose.translation() + arm) - place.value) / place.value_sigma;
      r[n_places + i] =
          (place.direction.dot(body.velocity + body.angular_velocity.cross(arm)) - place.rate) / place.rate_sigma;
    }
    r.tail(2 * n) = (x - usual).cwiseQuotient(sigma);
    return r;
  };
  const auto slope_at = [&](const VectorXd& x, const VectorXd& r) {
    MatrixXd slope(r.size(), 2 * n);
    for (Eigen::Index k = 0; k < 2 * n; ++k)
      slope.col(k) = (residual_at(x + DIFFERENCE * VectorXd::Unit(2 * n, k)) - r) / DIFFERENCE;
    return slope;
  };
  VectorXd x = usual, r = residual_at(x);
  for (int step = 0; step < MOST_STEPS; ++step) {
    VectorXd dx = -slope_at(x, r).colPivHouseholderQr().solve(r);
    while (dx.norm() > SMALL_STEP && !(residual_at(x + dx).squaredNorm() < r.squaredNorm())) dx /= 2;
    if (!(dx.norm() > SMALL_STEP)) break;
    x += dx;
    r = residual_at(x);
  }
  const MatrixXd slope = slope_at(x, r);
  const MatrixXd covariance = (slope.transpose() * slope).inverse();
  std::vector<JointStart> found;
  for (Eigen::Index i = 0; i < n; ++i) {
    const double position_sigma = std::sqrt(covariance(i, i)), rate_sigma = std::sqrt(covariance(n + i, n + i));
    if (position_sigma < criteria().support_covered * sigma[i])
      found.push_back({joints[std::size_t(i)], x[i], x[n + i], position_sigma, rate_sigma});
  }
  return found;
}

}  // namespace pvg::diagnose
