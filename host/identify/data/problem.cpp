#include "host/identify/data/problem.hpp"

#include <algorithm>
#include <cmath>

#include "host/base/error.hpp"
#include "host/formats/lut_file.hpp"
#include "host/identify/data/jitter.hpp"
#include "host/identify/data/resolve.hpp"
#include "host/identify/data/start_places.hpp"
#include "host/load/overview.hpp"
#include "host/load/recording/robot_set.hpp"

namespace pvg::diagnose {
namespace {

TargetTable table_of(const std::vector<double>& t, const std::vector<double>& values, double to_si) {
  TargetTable table;
  for (std::size_t i = 0; i < t.size(); ++i)
    if (std::isfinite(values[i])) {
      table.time.push_back(t[i]);
      table.value.push_back(values[i] * to_si);
    }
  return table;
}

std::vector<PathPoint> path_of(const MeasuredTable& table, const BodyInput& input, const Pose& start) {
  std::vector<PathPoint> path;
  const std::vector<double>& t = table["t"];
  for (std::size_t i = 0; i < t.size(); ++i) {
    PathPoint point{t[i], start};
    if (!input.position.empty())
      for (int k = 0; k < 3; ++k) point.pose.translation()[k] = input.to_si * table[input.position[std::size_t(k)]][i];
    if (!input.orientation.empty()) {
      const auto& q = input.orientation;
      point.pose.linear() =
          Eigen::Quaterniond(table[q[3]][i], table[q[0]][i], table[q[1]][i], table[q[2]][i]).normalized().matrix();
    }
    if (point.pose.matrix().allFinite()) path.push_back(point);
  }
  return path;
}

Run make_run(const Problem& problem, const RecordedRun& recorded, const std::vector<double>& to_si,
             const Inputs& inputs, const std::vector<TargetTable>& of_joint) {
  Run run;
  run.name = recorded.name;
  run.is_held_out = recorded.is_held_out;
  run.t = recorded.table["t"];
  const std::size_t n = run.t.size();
  for (std::size_t c = 0; c < problem.channels.size(); ++c) {
    const RecordedChannel& channel = problem.recording.channels[c];
    std::vector<double> values(n * channel.columns.size());
    for (std::size_t k = 0; k < channel.columns.size(); ++k) {
      const std::vector<double>& column = recorded.table[channel.columns[k]];
      for (std::size_t i = 0; i < n; ++i)
        values[i * channel.columns.size() + k] = to_si[c] * (std::isfinite(column[i]) ? column[i] : std::nan(""));
    }
    run.jitter_noise.push_back(jitter_noise(problem.channels[c], run.t, values));
    run.values.push_back(std::move(values));
    run.noise_scale.push_back(1);
  }
  const PhysicalScene& scene = problem.scene.scene;
  for (std::size_t j = 0; j < scene.joints.size(); ++j) {
    if (!is_driven(scene.joints[j])) continue;
    TargetTable table = of_joint[j];
    for (const JointInput& input : inputs.joints)
      if (input.joint == int(j)) table = table_of(run.t, recorded.table[input.column], input.to_si);
    if (table.time.empty()) throw UsageError(recorded.table.file.string() + ": an input holds no number at all");
    run.targets.push_back(std::move(table));
  }
  for (const BodyInput& input : inputs.bodies)
    run.prescribed.push_back(
        {input.rigid, path_of(recorded.table, input, scene.rigid_bodies[std::size_t(input.rigid)].pose)});
  return run;
}

// Joints in an order in which parents come first; what closes a loop is left out.
void find_coordinates(Problem& problem) {
  const PhysicalScene& scene = problem.scene.scene;
  std::vector<char> is_child(scene.rigid_bodies.size()), is_placed(scene.rigid_bodies.size());
  for (const Joint& joint : scene.joints) is_child[std::size_t(joint.child)] = true;
  for (std::size_t b = 0; b < is_placed.size(); ++b) {
    is_placed[b] = !is_child[b] || !can_move(scene.rigid_bodies[b]);
    if (is_placed[b] && can_move(scene.rigid_bodies[b])) problem.free_bodies.push_back(int(b));
  }
  for (bool found = true; found;) {
    found = false;
    for (std::size_t j = 0; j < scene.joints.size(); ++j) {
      const Joint& joint = scene.joints[j];
      if (!is_placed[std::size_t(joint.parent)] || is_placed[std::size_t(joint.child)]) continue;
      is_placed[std::size_t(joint.child)] = found = true;
      problem.coordinates.push_back(int(j));
    }
  }
}

bool is_measured(const Problem& problem, bool of_joint, int index) {
  return std::any_of(problem.channels.begin(), problem.channels.end(), [&](const Channel& c) {
    if (of_joint) return c.joint == index && c.sensor->start == StartRole::place;
    return c.rigid == index && (is_place_of_body(c) || is_point_of_body(c));
  });
}

// Whether places on the bodies that joints carry are enough to find all joints that no channel measures.
bool are_seen_by_places(const Problem& problem, const std::vector<int>& joints) {
  int n = 0;
  for (const Channel& c : problem.channels)
    if (is_place_of_body(c) || is_point_of_body(c)) n += c.width;
  return n >= int(joints.size());
}

bool can_restart(const Problem& problem) {
  const PhysicalScene& scene = problem.scene.scene;
  if (!scene.soft_bodies.empty() || !scene.cloths.empty()) return false;
  if (problem.recording.initial == Recording::Initial::given) return false;
  const std::vector<int> seen = joints_seen_by_places(problem);
  if (!are_seen_by_places(problem, seen)) return false;
  for (const int j : problem.coordinates) {
    const Joint& joint = scene.joints[std::size_t(j)];
    if (joint.type == Joint::Type::spherical) return false;
    const bool is_seen = std::find(seen.begin(), seen.end(), j) != seen.end();
    if (has_coordinate(joint) && !is_seen && !is_measured(problem, true, j)) return false;
  }
  for (const int b : problem.free_bodies)
    if (!is_measured(problem, false, b)) return false;
  return true;
}

void check_given(const Problem& problem) {
  for (const auto& [key, value] : problem.recording.given) {
    const std::array<std::string, 3> parts = parts_of(key, problem.recording.file.string() + ": `initial`");
    const int j = parts[0] == "joint" ? index_named(problem.scene.scene.joints, parts[1]) : -1;
    if (j < 0 || (parts[2] != "position" && parts[2] != "velocity"))
      throw UsageError(problem.recording.file.string() + ": `initial." + key +
                       "` must be joint/NAME/position or joint/NAME/velocity of a joint of the scene");
  }
}

// Pictures show the bodies as the scene file has them.
void check_pictures(const Problem& problem) {
  if (problem.recording.mask_sources.empty() && problem.recording.video_sources.empty()) return;
  const PhysicalScene& scene = problem.scene.scene;
  for (const Run& run : problem.runs) {
    const PhysicalScene of_run = scene_of(problem, run);
    for (std::size_t b = 0; b < scene.rigid_bodies.size(); ++b)
      if (of_run.rigid_bodies[b].collision.points != scene.rigid_bodies[b].collision.points)
        throw UsageError(problem.recording.file.string() + ": runs, " + run.name + ": `set` changes the shape of `" +
                         scene.rigid_bodies[b].name +
                         "`, which masks and videos do not follow; leave that run or the pictures out");
  }
}

// At least one channel must measure something that moves, and change.
void check_motion(const Problem& problem) {
  const PhysicalScene& scene = problem.scene.scene;
  bool any_moves = false, any_changes = false;
  for (std::size_t c = 0; c < problem.channels.size(); ++c) {
    const Channel& channel = problem.channels[c];
    // a plate that stands feels what moves on it
    const bool feels = channel.sensor->is_known_after_a_step &&
                       (!scene.soft_bodies.empty() || !scene.cloths.empty() ||
                        std::any_of(scene.rigid_bodies.begin(), scene.rigid_bodies.end(), can_move));
    any_moves = any_moves || feels || channel.rigid < 0 || can_move(scene.rigid_bodies[std::size_t(channel.rigid)]);
    bool any = false;
    for (const Run& run : problem.runs) {
      std::vector<double> low(std::size_t(channel.width), INFINITY), high(std::size_t(channel.width), -INFINITY);
      for (std::size_t i = 0; i < run.values[c].size(); ++i) {
        const double value = run.values[c][i];
        if (!std::isfinite(value)) continue;
        any = true;
        low[i % low.size()] = std::min(low[i % low.size()], value);
        high[i % low.size()] = std::max(high[i % low.size()], value);
      }
      for (std::size_t k = 0; k < low.size(); ++k) any_changes = any_changes || high[k] > low[k];
    }
    if (!any)
      throw UsageError(problem.recording.file.string() + ": the " + channel.name + " holds no number in any run");
  }
  if (!any_moves)
    throw UsageError(problem.recording.file.string() +
                     ": nothing is measured that can move; measure a body or joint that the scene lets move");
  if (!any_changes)
    throw UsageError(problem.recording.file.string() +
                     ": every channel is constant in every run, so there is no motion to explain");
}

}  // namespace

PhysicalScene scene_of(const Problem& problem, const Run& run) {
  PhysicalScene scene = problem.scene.scene;
  for (const SceneChange& change : run.changes) change(scene);
  return scene;
}

Problem make_problem(const std::filesystem::path& path) { return make_problem(load_recording(path)); }

Problem make_problem(Recording recording) {
  Problem problem;
  problem.recording = std::move(recording);
  const std::filesystem::path& file = problem.recording.scene;
  problem.scene = problem.recording.has_robots_alone ? load_robots_alone(file) : load_scene_run(file);
  PhysicalScene& scene = problem.scene.scene;
  std::vector<TargetTable> of_joint(scene.joints.size(), TargetTable{{0}, {0}});
  for (std::size_t j = 0, driven = 0; j < scene.joints.size(); ++j)
    if (is_driven(scene.joints[j])) of_joint[j] = problem.scene.targets[driven++];
  const Inputs inputs = resolve_inputs(problem);
  apply_priors(problem);
  if (!problem.recording.mask_sources.empty() || !problem.recording.video_sources.empty()) {
    problem.seen = problem.scene.scene;
    complete_for_viewing(problem.seen);
  }
  if (!problem.recording.video_sources.empty()) {
    problem.render = problem.scene.render;
    if (!problem.render.lut.empty()) problem.lut = read_lut(problem.render.lut);
  }
  std::vector<double> to_si;
  for (std::size_t c = 0; c < problem.recording.channels.size(); ++c) {
    const RecordedChannel& recorded = problem.recording.channels[c];
    const SensorKind& sensor = sensor_of(recorded.kind);
    Resolved resolved = sensor.resolve({problem.recording, scene, problem.seen,
                                        problem.recording.file.string() + ": channels[" + std::to_string(c) + "]"},
                                       recorded);
    resolved.channel.sensor = &sensor;
    problem.channels.push_back(std::move(resolved.channel));
    to_si.push_back(resolved.to_si);
  }
  for (const RecordedRun& run : problem.recording.runs) {
    problem.runs.push_back(make_run(problem, run, to_si, inputs, of_joint));
    const std::string place = problem.recording.file.string() + ": runs, " + run.name + ": ";
    problem.runs.back().changes = scene_changes(scene, file, run.set, place + "set");
    problem.runs.back().given = given_starts(scene, run.initial, place + "initial");
    problem.runs.back().pushes = known_pushes(scene, run, place + "disturbances");
  }
  find_coordinates(problem);
  problem.can_restart = can_restart(problem);
  check_given(problem);
  check_pictures(problem);
  check_motion(problem);
  return problem;
}

}  // namespace pvg::diagnose
