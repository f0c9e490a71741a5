#include "host/identify/search/motion_family.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "host/identify/channels/resolve.hpp"
#include "host/identify/criteria.hpp"

namespace pvg::diagnose {
namespace {

struct Shape {
  const char* name;
  double (*at)(double phase, double cycles);  // phase: 0 to 1 over the motion; starts at 0, within -1 to 1
};

double sine(double phase, double cycles) { return std::sin(2 * M_PI * cycles * phase); }
double triangle(double phase, double cycles) { return 2 / M_PI * std::asin(sine(phase, cycles)); }
double steps(double phase, double cycles) {
  const double s = sine(phase, cycles);
  return s > 0.5 ? 1 : s < -0.5 ? -1 : 0;
}
double chirp(double phase, double cycles) { return sine(phase * phase, cycles); }

constexpr Shape SHAPES[] = {{"a sine", sine}, {"a triangle", triangle}, {"steps", steps}, {"a chirp", chirp}};
constexpr double N_COMMANDS = 200;  // of a motion

double longest_of(const Problem& problem) {
  double longest = 0;
  for (const Run& run : problem.runs) longest = std::max(longest, run.t.back() - run.t.front());
  return std::min(longest, criteria().next_longest);
}

// To three digits: what a person sets up.
double rounded(double value) {
  if (value == 0) return 0;
  const double unit = std::pow(10, std::floor(std::log10(std::abs(value))) - 2);
  return std::round(value / unit) * unit;
}

// The largest distance of a command from where it begins, over all runs.
double amplitude_of(const Problem& problem, std::size_t driven) {
  double most = 0;
  for (const Run& run : problem.runs)
    for (const double value : run.targets[driven].value)
      most = std::max(most, std::abs(value - run.targets[driven].value.front()));
  return most;
}

// Whether a joint has a drive whose recorded commands change.
bool is_commanded(const Problem& problem, std::size_t joint) {
  const std::vector<Joint>& joints = problem.scene.scene.joints;
  if (!is_driven(joints[joint])) return false;
  std::size_t driven = 0;
  for (std::size_t j = 0; j < joint; ++j) driven += is_driven(joints[j]);
  return amplitude_of(problem, driven) > 0;
}

// A motion, and the same with loads on a body.
void with_loads(const Problem& problem, int body, PlannedMotion motion, std::vector<PlannedMotion>& out) {
  out.push_back(std::move(motion));
  const RigidBody& loaded = problem.scene.scene.rigid_bodies[std::size_t(body)];
  if (!out.back().has_recorded_size || !can_move(loaded)) return;
  for (const double share : criteria().next_loads) {
    PlannedMotion with = out.back();
    with.loaded = loaded.name;
    with.load = rounded(share * loaded.mass);
    if (!(with.load > 0)) continue;
    with.description += fmt::format(", with a load of {:g} kg on {}", with.load, loaded.name);
    out.push_back(std::move(with));
  }
}

PlannedMotion at_rest_in(const Window& window, double seconds, const Run& run) {
  PlannedMotion motion{"", seconds, window.initial, {}};
  for (const TargetTable& table : run.targets)
    motion.targets.push_back({{0, seconds}, {table.value[0], table.value[0]}});
  return motion;
}

void add_commands(const Problem& problem, const Inputs& inputs, const PlannedMotion& rest,
                  std::vector<PlannedMotion>& out) {
  std::size_t driven = 0;
  const std::vector<Joint>& joints = problem.scene.scene.joints;
  for (std::size_t i = 0; i < joints.size(); ++i) {
    const Joint& joint = joints[i];
    if (!is_driven(joint)) continue;
    const std::size_t j = driven++;
    if (!inputs.joints[i]) continue;
    const double amplitude = amplitude_of(problem, j);
    for (const Shape& shape : SHAPES)
      for (const double share : criteria().next_amplitudes)
        for (const double cycles : criteria().next_cycles) {
          if (amplitude == 0) continue;
          PlannedMotion motion = rest;
          motion.description = fmt::format("command of {}: {}, amplitude {:.3g}, {:g} cycles in {:.3g} s", joint.name,
                                           shape.name, share * amplitude, cycles, rest.seconds);
          TargetTable table;
          for (double i = 0; i <= N_COMMANDS; ++i) {
            table.time.push_back(rest.seconds * i / N_COMMANDS);
            table.value.push_back(rest.targets[j].value[0] + share * amplitude * shape.at(i / N_COMMANDS, cycles));
          }
          motion.targets[j] = std::move(table);
          motion.has_recorded_size = share == 1;
          with_loads(problem, joint.child, std::move(motion), out);
        }
  }
}

// Where the starts of short windows of all fitting runs have a joint: about which coordinate, and how far from there.
struct Reach {
  double middle = 0, most = 0;
};

// A joint on a spring swings about where it hangs, another one about zero.
Reach reach_of(const std::vector<Window>& windows, std::size_t joint, bool is_held) {
  double low = INFINITY, high = -INFINITY;
  for (const Window& window : windows) {
    low = std::min(low, window.initial.position[joint]);
    high = std::max(high, window.initial.position[joint]);
  }
  if (!(low <= high)) return {};
  if (is_held) return {(low + high) / 2, (high - low) / 2};
  return {0, std::max(std::abs(low), std::abs(high))};
}

void add_releases(const Problem& problem, const Inputs& inputs, const PlannedMotion& rest,
                  std::vector<PlannedMotion>& out) {
  const std::vector<Window> windows = make_windows(problem, false, criteria().locate_window, criteria().n_windows_most);
  for (const int j : problem.coordinates) {
    const Joint& joint = problem.scene.scene.joints[std::size_t(j)];
    if (!inputs.joints[std::size_t(j)] || is_commanded(problem, std::size_t(j)) || !has_coordinate(joint)) continue;
    const Reach reach = reach_of(windows, std::size_t(j), is_driven(joint));
    for (const double share : criteria().next_releases) {
      if (reach.most == 0) continue;
      PlannedMotion motion = rest;
      const double from = rounded(reach.middle + share * reach.most);
      motion.description = fmt::format("release of {} at rest from {:.3g}", joint.name, from);
      motion.initial.position[std::size_t(j)] = from;
      motion.initial.rate[std::size_t(j)] = 0;
      motion.has_recorded_size = share == 1;
      with_loads(problem, joint.child, std::move(motion), out);
    }
  }
}

void add_throws(const Problem& problem, const Inputs& inputs, const PlannedMotion& rest,
                std::vector<PlannedMotion>& out) {
  for (const int b : problem.free_bodies) {
    if (!inputs.bodies[std::size_t(b)]) continue;
    for (const double speed : criteria().next_speeds)
      for (const double turn : criteria().next_turns) {
        PlannedMotion motion = rest;
        Vec3& velocity = motion.initial.velocity[std::size_t(b)];
        velocity = speed * (Eigen::AngleAxisd(2 * M_PI * turn, Vec3::UnitZ()) * velocity);
        for (double& part : velocity) part = rounded(part);
        motion.description = fmt::format("{} thrown with the velocity {:.3g}, {:.3g}, {:.3g} m/s",
                                         problem.scene.scene.rigid_bodies[std::size_t(b)].name, velocity.x(),
                                         velocity.y(), velocity.z());
        motion.has_recorded_size = speed == 1;
        with_loads(problem, b, std::move(motion), out);
      }
  }
}

// The joints between a body and the ground, one after the other.
void mark_carriers(const PhysicalScene& scene, int body, std::vector<bool>& marked) {
  for (std::size_t n = 0; n < scene.joints.size(); ++n)
    for (std::size_t j = 0; j < scene.joints.size(); ++j)
      if (scene.joints[j].child == body) {
        marked[j] = true;
        body = scene.joints[j].parent;
      }
}

}  // namespace

Inputs all_inputs(const PhysicalScene& scene) {
  return {std::vector<bool>(scene.joints.size(), true), std::vector<bool>(scene.rigid_bodies.size(), true)};
}

std::vector<Inputs> inputs_of(const PhysicalScene& scene, const std::vector<const Candidate*>& in_doubt) {
  const Inputs none{std::vector<bool>(scene.joints.size(), false), std::vector<bool>(scene.rigid_bodies.size(), false)};
  Inputs first = none, next = none;
  for (const Candidate* candidate : in_doubt) {
    const auto is_target = [&](const auto& one) { return one.name == candidate->target; };
    const auto joint = std::find_if(scene.joints.begin(), scene.joints.end(), is_target);
    const auto body = std::find_if(scene.rigid_bodies.begin(), scene.rigid_bodies.end(), is_target);
    if (joint != scene.joints.end()) {
      first.joints[std::size_t(joint - scene.joints.begin())] = true;
      for (std::size_t j = 0; j < scene.joints.size(); ++j)
        if (scene.joints[j].child == joint->parent || scene.joints[j].parent == joint->child) next.joints[j] = true;
    } else if (body != scene.rigid_bodies.end()) {
      first.bodies[std::size_t(body - scene.rigid_bodies.begin())] = true;
      mark_carriers(scene, int(body - scene.rigid_bodies.begin()), first.joints);
    } else {
      return {all_inputs(scene)};
    }
  }
  for (std::size_t j = 0; j < scene.joints.size(); ++j) next.joints[j] = next.joints[j] && !first.joints[j];
  return {first, next};
}

std::vector<PlannedMotion> motion_family(const Problem& problem, const Inputs& inputs) {
  std::vector<PlannedMotion> motions;
  const std::vector<Window> windows = make_windows(problem, false, 0, problem.runs.size());
  if (windows.empty()) return motions;
  const PlannedMotion rest = at_rest_in(windows[0], longest_of(problem), problem.runs[std::size_t(windows[0].run)]);
  add_commands(problem, inputs, rest, motions);
  add_releases(problem, inputs, rest, motions);
  add_throws(problem, inputs, rest, motions);
  return motions;
}

Problem planned_problem(const Problem& problem, const std::vector<PlannedMotion>& motions) {
  Problem planned = problem;
  planned.recording.mask_sources.clear();
  planned.recording.video_sources.clear();
  planned.recording.runs.assign(motions.size(), problem.recording.runs.front());
  planned.runs.clear();
  const Run& like = problem.runs.front();
  const double interval = (like.t.back() - like.t.front()) / double(std::max<std::size_t>(like.t.size() - 1, 1));
  for (const PlannedMotion& motion : motions) {
    Run run;
    run.name = motion.description;
    const auto n = std::size_t(std::round(motion.seconds / interval)) + 1;
    for (std::size_t i = 0; i < n; ++i) run.t.push_back(std::min(double(i) * interval, motion.seconds));
    for (const Channel& channel : problem.channels)
      run.values.emplace_back(run.t.size() * std::size_t(channel.width), 0.0);
    run.noise_scale.assign(problem.channels.size(), 1);
    run.targets = motion.targets;
    if (motion.load > 0) run.changes.push_back(load_on(motion.loaded, motion.load));
    planned.runs.push_back(std::move(run));
  }
  return planned;
}

}  // namespace pvg::diagnose
