#include "host/identify/data/window.hpp"

#include <algorithm>
#include <cmath>

#include "host/identify/criteria.hpp"
#include "host/identify/data/measured_start.hpp"

namespace pvg::diagnose {
namespace {

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
