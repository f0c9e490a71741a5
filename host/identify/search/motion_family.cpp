#include "host/identify/search/motion_family.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

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

// The largest distance of a command from where it begins, over all runs.
double amplitude_of(const Problem& problem, std::size_t driven) {
  double most = 0;
  for (const Run& run : problem.runs)
    for (const double value : run.targets[driven].value)
      most = std::max(most, std::abs(value - run.targets[driven].value.front()));
  return most;
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
          out.push_back(std::move(motion));
        }
  }
}

// The coordinate of a joint farthest from zero among the starts of short windows of all fitting runs.
double farthest_of(const std::vector<Window>& windows, std::size_t joint) {
  double most = 0;
  for (const Window& window : windows) most = std::max(most, std::abs(window.initial.position[joint]));
  return most;
}

void add_releases(const Problem& problem, const Inputs& inputs, const PlannedMotion& rest,
                  std::vector<PlannedMotion>& out) {
  const std::vector<Window> windows = make_windows(problem, false, criteria().locate_window, criteria().n_windows_most);
  for (const int j : problem.coordinates) {
    const Joint& joint = problem.scene.scene.joints[std::size_t(j)];
    if (!inputs.joints[std::size_t(j)] || is_driven(joint) || joint.type == Joint::Type::spherical) continue;
    const double most = farthest_of(windows, std::size_t(j));
    for (const double share : criteria().next_releases) {
      if (most == 0) continue;
      PlannedMotion motion = rest;
      motion.description = fmt::format("release of {} at rest from {:.3g}", joint.name, share * most);
      motion.initial.position[std::size_t(j)] = share * most;
      motion.initial.rate[std::size_t(j)] = 0;
      out.push_back(std::move(motion));
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
        motion.description = fmt::format("{} thrown with the velocity {:.3g}, {:.3g}, {:.3g} m/s",
                                         problem.scene.scene.rigid_bodies[std::size_t(b)].name, velocity.x(),
                                         velocity.y(), velocity.z());
        out.push_back(std::move(motion));
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
    planned.runs.push_back(std::move(run));
  }
  return planned;
}

}  // namespace pvg::diagnose
