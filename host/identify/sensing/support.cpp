#include "host/identify/sensing/support.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "host/base/error.hpp"
#include "host/identify/criteria.hpp"
#include "host/identify/sensing/world.hpp"
#include "host/physics/step/simulation.hpp"

namespace pvg::diagnose {
namespace {

struct Support {
  Vec3 normal = Vec3::Zero();  // zero: it rests on nothing, or on several sides
  bool is_face = false;
};

Support support_of(const WorldState& state, int body) {
  Support support;
  std::vector<Vec3> normals, points;
  double force = 0;
  for (const ContactForce& contact : state.contacts) {
    if ((contact.first != body && contact.second != body) || contact.normal_force <= 0) continue;
    normals.push_back(contact.first == body ? contact.normal : Vec3(-contact.normal));
    points.push_back(contact.point);
    support.normal += contact.normal_force * normals.back();
    force += contact.normal_force;
  }
  if (force <= 0) return {};
  support.normal.normalize();
  for (const Vec3& normal : normals)
    if (normal.dot(support.normal) < criteria().support_same_normal) return {};
  Vec3 middle = Vec3::Zero();
  for (const Vec3& point : points) middle += point / double(points.size());
  Mat3 spread = Mat3::Zero();
  for (const Vec3& point : points) spread += (point - middle) * (point - middle).transpose();
  const Vec3 widths = Eigen::SelfAdjointEigenSolver<Mat3>(spread).eigenvalues().cwiseMax(0).cwiseSqrt();
  support.is_face = widths[1] > criteria().support_face_width * widths[2] && widths[2] > 0;
  return support;
}

// Standard deviation of a body's unknown of this kind along a direction; infinite: not measured.
double sigma_along(const Window& window, int body, Unknown::Kind kind, const Vec3& direction) {
  double square = 0, covered = 0;
  for (const Unknown& unknown : window.unknowns)
    if (unknown.index == body && unknown.kind == kind) {
      const double share = unknown.direction.dot(direction);
      square += std::pow(share * unknown.sigma / criteria().start_looseness, 2);
      covered += share * share;
    }
  return covered > criteria().support_covered ? std::sqrt(square) : INFINITY;
}

// Removes from a body's unknowns of one kind the part along `normal`, or keeps that part alone.
void keep_unknowns(Window& window, int body, Unknown::Kind kind, const Vec3& normal, bool keeps_normal) {
  std::vector<Unknown> kept;
  std::vector<Vec3> directions;
  for (Unknown unknown : window.unknowns) {
    if (unknown.index == body && unknown.kind == kind) {
      const Vec3 along = unknown.direction.dot(normal) * normal;
      Vec3 left = keeps_normal ? along : Vec3(unknown.direction - along);
      for (const Vec3& other : directions) left -= other.dot(left) * other;
      if (left.norm() < criteria().support_direction_left) continue;
      unknown.direction = left.normalized();
      directions.push_back(unknown.direction);
    }
    kept.push_back(unknown);
  }
  window.unknowns = std::move(kept);
}

// How far a turned body reaches against a direction from its frame's origin [m].
double reach_of(const RigidBody& body, const Mat3& turned, const Vec3& direction) {
  double reach = 0;
  for (const Vec3& point : body.collision.points) reach = std::max(reach, -direction.dot(turned * point));
  return reach;
}

// rest: where the body is when it has settled
void start_settled(Window& window, int body, const RigidBody& shape, const Support& support, const Pose& rest) {
  using Kind = Unknown::Kind;
  const Vec3& n = support.normal;
  const std::size_t b = std::size_t(body);
  Pose& pose = window.initial.pose[b];
  Vec3 &velocity = window.initial.velocity[b], &spin = window.initial.spin[b];
  const auto is_near = [&](Kind kind, const Vec3& by, const Vec3& direction) {
    return std::abs(by.dot(direction)) <= criteria().support_sigma * sigma_along(window, body, kind, direction);
  };
  const Vec3 shift = rest.translation() - pose.translation();
  if (!is_near(Kind::position, shift, n) || !is_near(Kind::velocity, velocity, n)) return;
  const Eigen::AngleAxisd apart(Mat3(rest.linear() * pose.linear().transpose()));
  const Vec3 turn = apart.angle() * apart.axis(), tilt = turn - n.dot(turn) * n, rocking = spin - n.dot(spin) * n;
  const bool is_turn_measured = std::isfinite(sigma_along(window, body, Kind::rotation, n));
  const bool is_flat = support.is_face && is_turn_measured && is_near(Kind::rotation, tilt, tilt.stableNormalized()) &&
                       is_near(Kind::spin, rocking, rocking.stableNormalized());
  // in its measured orientation: a round body rolls at one height, others rock
  const double higher = reach_of(shape, pose.linear(), n) - reach_of(shape, rest.linear(), n);
  const bool is_round = std::abs(higher) <= sigma_along(window, body, Kind::position, n);
  if (is_turn_measured && support.is_face && !is_flat && !is_round) return;
  pose.translation() += n.dot(shift) * n;
  if (is_turn_measured && !is_flat && is_round) pose.translation() += higher * n;
  velocity -= n.dot(velocity) * n;
  keep_unknowns(window, body, Kind::position, n, false);
  keep_unknowns(window, body, Kind::velocity, n, false);
  if (!is_flat) return;
  pose.linear() = (tilt.norm() > 0 ? Eigen::AngleAxisd(tilt.norm(), tilt.normalized()).toRotationMatrix()
                                   : Mat3(Mat3::Identity())) *
                  pose.linear();
  spin -= rocking;
  keep_unknowns(window, body, Kind::rotation, n, true);
  keep_unknowns(window, body, Kind::spin, n, true);
}

struct Rest {
  std::vector<Support> support;  // [n_free]
  std::vector<Pose> pose;        // [n_free]
};

// Where the free bodies of a window have come to rest; their supports are none if they have not.
Rest rest_of(const Problem& problem, const WorldState& before, const WorldState& after, double h) {
  Rest rest;
  for (const int b : problem.free_bodies) {
    const AffineMap &then = before.rigid[std::size_t(b)], &now = after.rigid[std::size_t(b)];
    Support support = support_of(after, b);
    if (std::abs(support.normal.dot(now.col(3) - then.col(3))) > criteria().settle_speed * h) support.normal.setZero();
    Pose pose = Pose::Identity();
    pose.linear() = Eigen::Quaterniond(Mat3(now.leftCols<3>())).normalized().toRotationMatrix();
    pose.translation() = now.col(3);
    rest.support.push_back(support);
    rest.pose.push_back(pose);
  }
  return rest;
}

// One window's scene with everything at rest and the drives holding still, simulated for settle_time.
Rest settled(Device& device, const Problem& problem, const PhysicalScene& scene, const Window& window) {
  InitialState initial = window.initial;
  std::fill(initial.rate.begin(), initial.rate.end(), 0.0);
  std::fill(initial.velocity.begin(), initial.velocity.end(), Vec3::Zero());
  std::fill(initial.spin.begin(), initial.spin.end(), Vec3::Zero());
  PhysicalScene world = world_of(problem, scene, window, initial);
  world.solver.integrator = SolverSettings::Integrator::implicit_euler;  // which damps
  const double h = world.solver.time_step;
  const std::vector<double> targets = targets_of(world, problem.runs[std::size_t(window.run)], window.start, h);
  try {
    Simulation simulation(device, world);
    WorldState before;
    for (int step = 0; step < int(std::ceil(criteria().settle_time / h)); ++step) {
      before = simulation.state();
      simulation.step(targets);
    }
    return rest_of(problem, before, simulation.state(), h);
  } catch (const StepFailure&) {
    return {};
  } catch (const UsageError&) {  // a start that cannot be
    return {};
  }
}

}  // namespace

void settle_on_support(Device& device, const Problem& problem, const PhysicalScene& scene, Window& window) {
  if (problem.free_bodies.empty() || window.unknowns.empty()) return;
  const Rest rest = settled(device, problem, scene, window);
  for (std::size_t i = 0; i < rest.support.size(); ++i)
    if (const int b = problem.free_bodies[i]; rest.support[i].normal.norm() > 0)
      start_settled(window, b, scene.rigid_bodies[std::size_t(b)], rest.support[i], rest.pose[i]);
}

}  // namespace pvg::diagnose
