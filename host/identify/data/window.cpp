#include "host/identify/data/window.hpp"

#include <algorithm>
#include <cmath>

#include "host/identify/criteria.hpp"
#include "host/identify/data/start_places.hpp"

namespace pvg::diagnose {
namespace {

struct LocalFit {
  double value = 0, slope = 0, value_sigma = 0, slope_sigma = 0;
  bool is_there = false;
};

// Numbers of the samples of component k, by their distance in time from t0 [s].
std::vector<std::pair<double, std::size_t>> samples_around(const std::vector<double>& t,
                                                           const std::vector<double>& values, std::size_t width,
                                                           std::size_t k, double t0) {
  std::vector<std::pair<double, std::size_t>> near;
  for (std::size_t i = 0; i < t.size(); ++i)
    if (std::isfinite(values[i * width + k])) near.push_back({std::abs(t[i] - t0), i});
  std::sort(near.begin(), near.end());
  return near;
}

// A parabola through the samples around time t0 of component k: value and slope there. Where the run begins, and a
// constant explains its first samples as well, the value is their mean and the slope 0: the few samples that are near
// enough for the parabola give a rate of up to some sigma to what is at rest, and the law of what sticks or has play
// has a kink there, over which no fit of the start leads.
LocalFit fit_around(const std::vector<double>& t, const std::vector<double>& values, std::size_t width, std::size_t k,
                    double t0, double sigma) {
  const std::vector<std::pair<double, std::size_t>> near = samples_around(t, values, width, k, t0);
  const std::size_t most = std::min(criteria().start_n_most, near.size());
  std::size_t n = std::min(criteria().start_n_least, near.size());
  while (n < most && near[n].first < criteria().start_fit_span / 2) ++n;
  LocalFit fit;
  if (n < 3) return fit;
  const auto system = [&](std::size_t n_rows) {
    std::pair<Eigen::MatrixXd, Eigen::VectorXd> of{Eigen::MatrixXd(n_rows, 3), Eigen::VectorXd(n_rows)};
    for (std::size_t i = 0; i < n_rows; ++i) {
      const double dt = t[near[i].second] - t0;
      of.first.row(Eigen::Index(i)) << 1, dt, dt * dt;
      of.second[Eigen::Index(i)] = values[near[i].second * width + k];
    }
    return of;
  };
  const auto [a, b] = system(n);
  const Eigen::Matrix3d normal = a.transpose() * a;
  Vec3 x = a.colPivHouseholderQr().solve(b);
  const Eigen::Matrix3d covariance = sigma * sigma * normal.completeOrthogonalDecomposition().pseudoInverse();
  if (t0 <= t.front() && most >= criteria().start_n_least) {
    const auto [wide, first] = system(most);
    const double mean = first.mean(), of_constant = (first.array() - mean).square().sum(),
                 of_parabola = (first - wide * wide.colPivHouseholderQr().solve(first)).squaredNorm();
    if (of_constant - of_parabola <= criteria().start_rest_most * sigma * sigma) x << mean, 0, 0;
  }
  return {x[0], x[1], std::sqrt(std::max(covariance(0, 0), 0.0)), std::sqrt(std::max(covariance(1, 1), 0.0)), true};
}

// Rotation vectors of the orientation relative to the sample nearest to t0.
struct TurnFit {
  Mat3 rotation = Mat3::Identity();
  Vec3 spin = Vec3::Zero();
  double sigma = 0, spin_sigma = 0;
};

TurnFit turn_around(const Run& run, const std::vector<double>& values, double t0, double sigma) {
  TurnFit fit;
  const auto rotation = [&](std::size_t i) {
    const double* q = &values[4 * i];
    return Eigen::Quaterniond(q[3], q[0], q[1], q[2]).normalized().toRotationMatrix();
  };
  std::size_t nearest = run.t.size();
  for (std::size_t i = 0; i < run.t.size(); ++i)
    if (std::isfinite(values[4 * i]) &&
        (nearest == run.t.size() || std::abs(run.t[i] - t0) < std::abs(run.t[nearest] - t0)))
      nearest = i;
  if (nearest == run.t.size()) return fit;
  const Mat3 at = rotation(nearest);
  std::vector<double> turned(3 * run.t.size(), std::nan(""));
  for (std::size_t i = 0; i < run.t.size(); ++i) {
    if (!std::isfinite(values[4 * i]) || std::abs(run.t[i] - t0) > criteria().start_turn_span) continue;
    const Mat3 apart = rotation(i) * at.transpose();
    const Eigen::AngleAxisd turn(apart);
    Vec3::Map(&turned[3 * i]) = turn.angle() * turn.axis();
  }
  Vec3 value = Vec3::Zero();
  for (std::size_t k = 0; k < 3; ++k) {
    const LocalFit one = fit_around(run.t, turned, 3, k, t0, sigma);
    value[Eigen::Index(k)] = one.value;
    fit.spin[Eigen::Index(k)] = one.slope;
    fit.sigma = std::max(fit.sigma, one.value_sigma);
    fit.spin_sigma = std::max(fit.spin_sigma, one.slope_sigma);
  }
  fit.rotation =
      (value.norm() > 0 ? Eigen::AngleAxisd(value.norm(), value.normalized()).toRotationMatrix() : Mat3::Identity()) *
      at;
  return fit;
}

struct Start {
  InitialState state;
  std::vector<Unknown> unknowns;
};

void start_joint(const Problem& problem, const Run& run, int j, double t0, bool is_given, Start& start) {
  const bool turns = problem.scene.scene.joints[std::size_t(j)].type == Joint::Type::revolute;
  const double usual = turns ? criteria().start_unmeasured_turn : criteria().start_unmeasured_shift;
  double position_sigma = usual, rate_sigma = criteria().start_unmeasured_rate * usual;
  bool is_measured = false, is_rate_measured = false;
  for (std::size_t c = 0; c < problem.channels.size(); ++c) {
    const Channel& channel = problem.channels[c];
    const StartRole role = channel.sensor->start;
    if (channel.joint != j || (role != StartRole::place && role != StartRole::rate)) continue;
    const LocalFit fit = fit_around(run.t, run.values[c], 1, 0, t0, noise_in(problem, run, c));
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

bool is_along(const Vec3& a, const Vec3& b) { return std::abs(a.dot(b)) > criteria().support_same_normal; }

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
      const LocalFit fit =
          fit_around(run.t, run.values[c], std::size_t(channel.width), std::size_t(k), t0, noise_in(problem, run, c));
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
      const TurnFit fit = turn_around(run, run.values[c], t0, noise_in(problem, run, c));
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
      const LocalFit fit =
          fit_around(run.t, run.values[c], std::size_t(channel.width), std::size_t(k), t0, noise_in(problem, run, c));
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
  for (const JointStart& found : joints_from_places(problem, start.state, joints, places)) {
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

Start start_of(const Problem& problem, const Run& run, double t0) {
  const PhysicalScene& scene = problem.scene.scene;
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

double& coordinate_of(InitialState& state, const Unknown& unknown) {
  return unknown.kind == Unknown::Kind::joint_rate ? state.rate[std::size_t(unknown.index)]
                                                   : state.position[std::size_t(unknown.index)];
}

Vec3 vector_of(const InitialState& state, const Unknown& unknown) {
  const std::size_t i = std::size_t(unknown.index);
  return unknown.kind == Unknown::Kind::position   ? Vec3(state.pose[i].translation())
         : unknown.kind == Unknown::Kind::velocity ? state.velocity[i]
                                                   : state.spin[i];
}

// What the recording states of a run's start holds instead of what its first samples say.
void start_as_given(const GivenStart& given, Start& start) {
  const Unknown& stated = given.unknown;
  const bool is_of_joint = stated.kind == Unknown::Kind::joint_position || stated.kind == Unknown::Kind::joint_rate;
  if (is_of_joint)
    coordinate_of(start.state, stated) = given.value;
  else
    move(start.state, stated, given.value - stated.direction.dot(vector_of(start.state, stated)));
  std::erase_if(start.unknowns, [&](const Unknown& one) {
    return one.kind == stated.kind && one.index == stated.index &&
           (is_of_joint || is_along(one.direction, stated.direction));
  });
  if (stated.sigma > 0) start.unknowns.push_back(stated);
}

Window make_window(const Problem& problem, int number, double begin, double end) {
  const Run& run = problem.runs[std::size_t(number)];
  Start start = start_of(problem, run, begin);
  if (begin == run.t.front())
    for (const GivenStart& given : run.given) start_as_given(given, start);
  Window window{number, begin, end, std::move(start.state), std::move(start.unknowns), {}, false, {}};
  for (std::size_t c = 0; c < problem.channels.size(); ++c) {
    const Channel& channel = problem.channels[c];
    for (std::size_t i = 0; i < run.t.size(); ++i) {
      if (run.t[i] < begin || run.t[i] > end) continue;
      bool is_whole = true;
      for (int k = 0; k < channel.width; ++k)
        is_whole = is_whole && std::isfinite(run.values[c][i * std::size_t(channel.width) + std::size_t(k)]);
      for (int k = 0; k < channel.n && is_whole; ++k) window.data.push_back({int(c), i, k});
    }
  }
  return window;
}

}  // namespace

std::vector<Window> make_windows(const Problem& problem, bool held_out, double length, std::size_t most) {
  std::vector<std::array<double, 3>> spans;  // run, begin, end
  for (std::size_t r = 0; r < problem.runs.size(); ++r) {
    const Run& run = problem.runs[r];
    if (run.is_held_out != held_out) continue;
    const double begin = run.t.front(), all = run.t.back() - begin;
    const int n = length > 0 && problem.can_restart ? std::max(1, int(all / length + criteria().window_missing)) : 1;
    for (int i = 0; i < n; ++i) spans.push_back({double(r), begin + all * i / n, begin + all * (i + 1) / n});
  }
  std::vector<Window> windows;
  const std::size_t n = std::min(most, spans.size());
  for (std::size_t i = 0; i < n; ++i) {
    const std::array<double, 3>& span = spans[i * spans.size() / n];
    Window window = make_window(problem, int(span[0]), span[1], span[2]);
    if (window.data.size() > window.unknowns.size() + 2) windows.push_back(std::move(window));
  }
  return windows;
}

void move(InitialState& initial, const Unknown& unknown, double by) {
  const std::size_t i = std::size_t(unknown.index);
  switch (unknown.kind) {
    case Unknown::Kind::joint_position:
      initial.position[i] += by;
      break;
    case Unknown::Kind::joint_rate:
      initial.rate[i] += by;
      break;
    case Unknown::Kind::position:
      initial.pose[i].translation() += by * unknown.direction;
      break;
    case Unknown::Kind::rotation:
      initial.pose[i].linear() = Eigen::AngleAxisd(by, unknown.direction).toRotationMatrix() * initial.pose[i].linear();
      break;
    case Unknown::Kind::velocity:
      initial.velocity[i] += by * unknown.direction;
      break;
    case Unknown::Kind::spin:
      initial.spin[i] += by * unknown.direction;
      break;
  }
}

void start_at(const Problem& problem, const InitialState& initial, PhysicalScene& scene) {
  std::vector<Pose> before;
  for (const RigidBody& body : scene.rigid_bodies) before.push_back(body.pose);
  for (const int b : problem.free_bodies) {
    RigidBody& body = scene.rigid_bodies[std::size_t(b)];
    body.pose = initial.pose[std::size_t(b)];
    body.velocity = initial.velocity[std::size_t(b)];
    body.angular_velocity = initial.spin[std::size_t(b)];
  }
  for (const int j : problem.coordinates) {
    Joint& joint = scene.joints[std::size_t(j)];
    const RigidBody& parent = scene.rigid_bodies[std::size_t(joint.parent)];
    RigidBody& child = scene.rigid_bodies[std::size_t(joint.child)];
    if (joint.type == Joint::Type::spherical) continue;
    const double q = initial.position[std::size_t(j)], rate = initial.rate[std::size_t(j)];
    Pose motion = Pose::Identity();
    const Pose frame = parent.pose * joint.parent_frame;
    const Vec3 axis = frame.linear() * joint.axis.normalized();
    if (joint.type == Joint::Type::revolute)
      motion.linear() = Eigen::AngleAxisd(q, joint.axis.normalized()).toRotationMatrix();
    if (joint.type == Joint::Type::prismatic) motion.translation() = q * joint.axis.normalized();
    child.pose = frame * motion * joint.child_frame.inverse();
    const bool turns = joint.type == Joint::Type::revolute, slides = joint.type == Joint::Type::prismatic;
    child.angular_velocity = parent.angular_velocity + (turns ? Vec3(rate * axis) : Vec3::Zero());
    const Vec3 at = parent.velocity + parent.angular_velocity.cross(frame.translation() - parent.pose.translation());
    child.velocity = at + (slides ? Vec3(rate * axis + parent.angular_velocity.cross(q * axis)) : Vec3::Zero()) +
                     child.angular_velocity.cross(child.pose.translation() - frame.translation() -
                                                  (slides ? Vec3(q * axis) : Vec3::Zero()));
    joint.initial = q;
  }
  for (const Stitch& stitch : scene.stitches) {  // what hangs on a link goes with it
    const Pose by = scene.rigid_bodies[std::size_t(stitch.rigid)].pose * before[std::size_t(stitch.rigid)].inverse();
    if (stitch.soft >= 0 && !by.isApprox(Pose::Identity(), 1e-14))
      scene.soft_bodies[std::size_t(stitch.soft)].pose = by * scene.soft_bodies[std::size_t(stitch.soft)].pose;
  }
}

}  // namespace pvg::diagnose
