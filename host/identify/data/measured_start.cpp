#include "host/identify/data/measured_start.hpp"

#include <algorithm>
#include <cmath>

#include "host/identify/criteria.hpp"
#include "host/identify/data/jitter.hpp"
#include "host/identify/data/start_fit.hpp"
#include "host/identify/data/start_places.hpp"

namespace pvg::diagnose {

bool is_along(const Vec3& a, const Vec3& b) { return std::abs(a.dot(b)) > criteria().support_same_normal; }

namespace {

void start_joint(const Problem& problem, const Run& run, int j, double t0, bool is_given, Start& start) {
  const bool turns = problem.scene.scene.joints[std::size_t(j)].type == Joint::Type::revolute;
  const double usual = turns ? criteria().start_unmeasured_turn : criteria().start_unmeasured_shift;
  double position_sigma = usual, rate_sigma = criteria().start_unmeasured_rate * usual;
  bool is_measured = false, is_rate_measured = false;
  for (std::size_t c = 0; c < problem.channels.size(); ++c) {
    const Channel& channel = problem.channels[c];
    const StartRole role = channel.sensor->start;
    if (channel.joint != j || (role != StartRole::place && role != StartRole::rate)) continue;
    const LocalFit fit = fit_around(run.t, run.values[c], 1, 0, t0, noise_around(problem, run, c, t0));
    if (!fit.is_there) continue;
    if (role == StartRole::rate) {
      start.state.rate[std::size_t(j)] = fit.value;
      rate_sigma = criteria().start_looseness * fit.value_sigma;
      is_rate_measured = true;
      continue;
    }
    is_measured = true;
    start.state.position[std::size_t(j)] = fit.value;
    position_sigma = criteria().start_looseness * fit.value_sigma;
    if (!is_rate_measured) {
      start.state.rate[std::size_t(j)] = fit.slope;
      rate_sigma = criteria().start_looseness * fit.slope_sigma;
    }
  }
  if (is_given || (!is_measured && problem.recording.initial != Recording::Initial::fitted)) return;
  start.unknowns.push_back({Unknown::Kind::joint_position, j, Vec3::UnitX(), position_sigma});
  start.unknowns.push_back({Unknown::Kind::joint_rate, j, Vec3::UnitX(), rate_sigma});
}

bool is_among(const std::vector<Vec3>& directions, const Vec3& direction) {
  return std::any_of(directions.begin(), directions.end(), [&](const Vec3& one) { return is_along(one, direction); });
}

bool is_velocity_along(const Unknown& unknown, const Vec3& direction) {
  return unknown.kind == Unknown::Kind::velocity && is_along(unknown.direction, direction);
}

// What channels of one sort say of places on rigid bodies around t0.
std::vector<MeasuredPlace> places_at(const Problem& problem, const Run& run, double t0,
                                     bool (&belongs)(const Channel&)) {
  std::vector<MeasuredPlace> places;
  for (std::size_t c = 0; c < problem.channels.size(); ++c) {
    const Channel& channel = problem.channels[c];
    if (!belongs(channel)) continue;
    for (int k = 0; k < channel.width; ++k) {
      const LocalFit fit = fit_around(run.t, run.values[c], std::size_t(channel.width), std::size_t(k), t0,
                                      noise_around(problem, run, c, t0));
      const Vec3 direction = channel.has_axis ? channel.axis : Vec3(Vec3::Unit(k));
      if (fit.is_there)
        places.push_back(
            {channel.rigid, channel.point, direction, fit.value, fit.value_sigma, fit.slope, fit.slope_sigma});
    }
  }
  return places;
}

void start_body(const Problem& problem, const Run& run, int b, double t0, bool is_given, Start& start) {
  Pose& pose = start.state.pose[std::size_t(b)];
  Vec3& velocity = start.state.velocity[std::size_t(b)];
  std::vector<Unknown> unknowns;
  std::vector<Vec3> measured_rates;  // directions of velocities that a channel of its own measures
  for (std::size_t c = 0; c < problem.channels.size(); ++c) {
    const Channel& channel = problem.channels[c];
    if (channel.rigid != b) continue;
    if (channel.sensor->start == StartRole::turn) {
      const TurnFit fit = turn_around(run, run.values[c], t0, noise_around(problem, run, c, t0));
      pose.linear() = fit.rotation;
      start.state.spin[std::size_t(b)] = fit.spin;
      for (int k = 0; k < 3; ++k) {
        unknowns.push_back({Unknown::Kind::rotation, b, Vec3::Unit(k), criteria().start_looseness * fit.sigma});
        unknowns.push_back({Unknown::Kind::spin, b, Vec3::Unit(k), criteria().start_looseness * fit.spin_sigma});
      }
    }
    const StartRole role = channel.sensor->start;
    if (role != StartRole::place && role != StartRole::rate) continue;
    for (int k = 0; k < channel.width; ++k) {
      const LocalFit fit = fit_around(run.t, run.values[c], std::size_t(channel.width), std::size_t(k), t0,
                                      noise_around(problem, run, c, t0));
      if (!fit.is_there) continue;
      const Vec3 direction = channel.has_axis ? channel.axis : Vec3(Vec3::Unit(k));
      if (role == StartRole::rate) {
        velocity += direction * (fit.value - direction.dot(velocity));
        std::erase_if(unknowns, [&](const Unknown& one) { return is_velocity_along(one, direction); });
        unknowns.push_back({Unknown::Kind::velocity, b, direction, criteria().start_looseness * fit.value_sigma});
        measured_rates.push_back(direction);
        continue;
      }
      pose.translation() += direction * (fit.value - direction.dot(pose.translation()));
      unknowns.push_back({Unknown::Kind::position, b, direction, criteria().start_looseness * fit.value_sigma});
      if (is_among(measured_rates, direction)) continue;
      velocity += direction * (fit.slope - direction.dot(velocity));
      unknowns.push_back({Unknown::Kind::velocity, b, direction, criteria().start_looseness * fit.slope_sigma});
    }
  }
  const auto has_place = [&](const Vec3& direction) {
    return std::any_of(unknowns.begin(), unknowns.end(), [&](const Unknown& one) {
      return one.kind == Unknown::Kind::position && is_along(one.direction, direction);
    });
  };
  for (const MeasuredPlace& place : places_at(problem, run, t0, is_point_of_body)) {
    if (place.rigid != b || has_place(place.direction)) continue;
    const Vec3 arm = pose.linear() * place.point, &direction = place.direction;
    pose.translation() += direction * (place.value - direction.dot(pose.translation() + arm));
    unknowns.push_back({Unknown::Kind::position, b, direction, criteria().start_looseness * place.value_sigma});
    if (is_among(measured_rates, direction)) continue;
    velocity += direction * (place.rate - direction.dot(velocity + start.state.spin[std::size_t(b)].cross(arm)));
    unknowns.push_back({Unknown::Kind::velocity, b, direction, criteria().start_looseness * place.rate_sigma});
  }
  if (!is_given) start.unknowns.insert(start.unknowns.end(), unknowns.begin(), unknowns.end());
}

// Joints that channels of their bodies alone tell of.
void start_joints_by_places(const Problem& problem, const Run& run, double t0, Start& start) {
  const std::vector<int> joints = joints_seen_by_places(problem);
  if (joints.empty()) return;
  std::vector<MeasuredPlace> places = places_at(problem, run, t0, is_place_of_body);
  const std::vector<MeasuredPlace> points = places_at(problem, run, t0, is_point_of_body);
  places.insert(places.end(), points.begin(), points.end());
  for (const JointStart& found : joints_from_places(problem, run, start.state, joints, places)) {
    start.state.position[std::size_t(found.joint)] = found.position;
    start.state.rate[std::size_t(found.joint)] = found.rate;
    std::erase_if(start.unknowns, [&](const Unknown& one) {
      return one.index == found.joint &&
             (one.kind == Unknown::Kind::joint_position || one.kind == Unknown::Kind::joint_rate);
    });
    const double looseness = criteria().start_looseness;
    start.unknowns.push_back(
        {Unknown::Kind::joint_position, found.joint, Vec3::UnitX(), looseness * found.position_sigma});
    start.unknowns.push_back({Unknown::Kind::joint_rate, found.joint, Vec3::UnitX(), looseness * found.rate_sigma});
  }
}

}  // namespace

Start start_of(const Problem& problem, const Run& run, double t0) {
  const PhysicalScene scene = scene_of(problem, run);
  Start start;
  for (const Joint& joint : scene.joints) start.state.position.push_back(joint.initial);
  start.state.rate.assign(scene.joints.size(), 0);
  for (const RigidBody& body : scene.rigid_bodies) {
    start.state.pose.push_back(body.pose);
    start.state.velocity.push_back(body.velocity);
    start.state.spin.push_back(body.angular_velocity);
  }
  const bool is_given = problem.recording.initial == Recording::Initial::given;
  if (is_given) {
    for (std::size_t j = 0; j < scene.joints.size(); ++j)
      for (const auto& [key, value] : problem.recording.given) {
        if (key == "joint/" + scene.joints[j].name + "/position") start.state.position[j] = value;
        if (key == "joint/" + scene.joints[j].name + "/velocity") start.state.rate[j] = value;
      }
    return start;
  }
  for (const int j : problem.coordinates)
    if (scene.joints[std::size_t(j)].type == Joint::Type::revolute ||
        scene.joints[std::size_t(j)].type == Joint::Type::prismatic)
      start_joint(problem, run, j, t0, is_given, start);
  for (const int b : problem.free_bodies) start_body(problem, run, b, t0, is_given, start);
  start_joints_by_places(problem, run, t0, start);
  return start;
}

}  // namespace pvg::diagnose
