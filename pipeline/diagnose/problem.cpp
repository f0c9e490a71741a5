#include "pipeline/diagnose/problem.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "host/base/error.hpp"
#include "host/scene/yaml_section.hpp"
#include "pipeline/diagnose/embedded_point.hpp"

namespace pvg::diagnose {
namespace {

using Kind = RecordedChannel::Kind;

bool has_coordinate(const Joint& joint) {
  return joint.type == Joint::Type::revolute || joint.type == Joint::Type::prismatic;
}

template <class List>
int index_of(const List& list, const std::string& name) {
  for (std::size_t i = 0; i < list.size(); ++i)
    if (list[i].name == name) return int(i);
  return -1;
}

// to SI; an empty unit is SI
double factor_of(const std::string& unit, Unit dimension, const std::string& place) {
  if (unit.empty()) return 1;
  try {
    return parse_quantity("1 " + unit, dimension);
  } catch (const std::invalid_argument& wrong) {
    throw UsageError(place + ": `unit` " + wrong.what());
  }
}

Unit dimension_of(Kind kind, bool turns, bool of_joint) {
  switch (kind) {
    case Kind::rate:
      return turns ? Unit::angular_speed : Unit::speed;
    case Kind::torque:
      return turns ? Unit::torque : Unit::force;
    case Kind::force:
      return Unit::force;
    case Kind::orientation:
      return Unit::none;
    default:
      return of_joint && turns ? Unit::angle : Unit::length;
  }
}

struct Resolved {
  Channel channel;
  double to_si = 1;
};

void find_body(const Scene& scene, const RecordedChannel& recorded, const std::string& place, Channel& channel) {
  channel.rigid = index_of(scene.rigid_bodies, recorded.body);
  channel.soft = index_of(scene.soft_bodies, recorded.body);
  channel.cloth = index_of(scene.cloths, recorded.body);
  if (channel.rigid < 0 && channel.soft < 0 && channel.cloth < 0) {
    std::string known;
    for (const RigidBody& body : scene.rigid_bodies) known += (known.empty() ? "" : ", ") + body.name;
    for (const SoftBody& body : scene.soft_bodies) known += (known.empty() ? "" : ", ") + body.name;
    for (const Cloth& body : scene.cloths) known += (known.empty() ? "" : ", ") + body.name;
    throw UsageError(place + " names the body `" + recorded.body +
                     "`, which the scene does not have; it has: " + known);
  }
  if (channel.rigid < 0 && recorded.kind != Kind::marker && recorded.kind != Kind::force)
    throw UsageError(place + ": `" + recorded.body +
                     "` has no one position or orientation; name a point of it by the kind `marker`");
  if (recorded.kind != Kind::marker) return;
  if (channel.rigid >= 0) {
    const TriangleMesh& mesh = scene.rigid_bodies[std::size_t(channel.rigid)].collision;
    if (recorded.vertex >= int(mesh.points.size()))
      throw UsageError(place + ": `vertex` is beyond the " + std::to_string(mesh.points.size()) + " of `" +
                       recorded.body + "`");
    channel.point = recorded.point ? *recorded.point : mesh.points[std::size_t(recorded.vertex)];
    return;
  }
  const std::size_t n = channel.soft >= 0 ? scene.soft_bodies[std::size_t(channel.soft)].mesh.points.size()
                                          : scene.cloths[std::size_t(channel.cloth)].mesh.points.size();
  if (recorded.vertex >= int(n))
    throw UsageError(place + ": `vertex` is beyond the " + std::to_string(n) + " of `" + recorded.body + "`");
  if (recorded.vertex >= 0)
    channel.nodes = {{std::uint32_t(recorded.vertex), 1.0}};
  else if (channel.soft >= 0)
    channel.nodes = embed(scene.soft_bodies[std::size_t(channel.soft)].mesh, *recorded.point);
  else
    channel.nodes = embed(scene.cloths[std::size_t(channel.cloth)].mesh, *recorded.point);
}

Resolved resolve(const Problem& problem, std::size_t number) {
  const Scene& scene = problem.scene.scene;
  const RecordedChannel& recorded = problem.recording.channels[number];
  const std::string place = problem.recording.file.string() + ": channels[" + std::to_string(number) + "]";
  Resolved resolved;
  Channel& channel = resolved.channel;
  channel.kind = recorded.kind;
  bool turns = false;
  if (!recorded.joint.empty()) {
    channel.joint = index_of(scene.joints, recorded.joint);
    if (channel.joint < 0)
      throw UsageError(place + " names the joint `" + recorded.joint + "`, which the scene does not have");
    const Joint& joint = scene.joints[std::size_t(channel.joint)];
    if (!has_coordinate(joint))
      throw UsageError(place + ": the joint `" + recorded.joint + "` is fixed or a ball joint and has no position");
    turns = joint.type == Joint::Type::revolute;
    channel.subject = scene.rigid_bodies[std::size_t(joint.child)].name;
    channel.name = std::string(kind_name(recorded.kind)) + " of joint " + recorded.joint;
  } else {
    find_body(scene, recorded, place, channel);
    channel.subject = recorded.body;
    channel.name = std::string(kind_name(recorded.kind)) + " of " + recorded.body;
  }
  const Unit dimension = dimension_of(recorded.kind, turns, channel.joint >= 0);
  resolved.to_si = factor_of(recorded.unit, dimension, place);
  channel.unit = recorded.kind == Kind::orientation ? "rad" : si_unit(dimension);
  channel.width = int(recorded.columns.size());
  channel.n = recorded.kind == Kind::orientation ? 3 : channel.width;
  channel.has_axis = recorded.axis.has_value();
  if (recorded.axis) channel.axis = *recorded.axis;
  if (channel.n > 1 || problem.recording.channels.size() > 1) channel.name += " (" + recorded.columns[0] + ")";
  channel.is_noise_known = recorded.noise > 0;
  channel.sigma = channel.is_noise_known ? recorded.noise * resolved.to_si : 0;
  return resolved;
}

TargetTable table_of(const std::vector<double>& t, const std::vector<double>& values, double to_si) {
  TargetTable table;
  for (std::size_t i = 0; i < t.size(); ++i)
    if (std::isfinite(values[i])) {
      table.time.push_back(t[i]);
      table.value.push_back(values[i] * to_si);
    }
  return table;
}

struct JointInput {
  int joint = -1;
  std::string column;
  double to_si = 1;
};
struct BodyInput {
  int rigid = -1;
  std::vector<std::string> position, orientation;
  double to_si = 1;
};
struct Inputs {
  std::vector<JointInput> joints;
  std::vector<BodyInput> bodies;
};

// joint/NAME/QUANTITY in three parts; names may hold slashes
std::array<std::string, 3> parts_of(const std::string& target, const std::string& place) {
  const std::size_t first = target.find('/'), last = target.rfind('/');
  if (first == std::string::npos || first == last)
    throw UsageError(place + ": `target` must be such as joint/NAME/position, but is `" + target + "`");
  return {target.substr(0, first), target.substr(first + 1, last - first - 1), target.substr(last + 1)};
}

void resolve_joint_input(Scene& scene, const RecordedInput& input, const std::array<std::string, 3>& parts,
                         const std::string& place, Inputs& inputs) {
  const int j = index_of(scene.joints, parts[1]);
  if (j < 0) throw UsageError(place + " names the joint `" + parts[1] + "`, which the scene does not have");
  Joint& joint = scene.joints[std::size_t(j)];
  if (!has_coordinate(joint)) throw UsageError(place + ": the joint `" + parts[1] + "` cannot be driven");
  const bool turns = joint.type == Joint::Type::revolute;
  Unit unit = turns ? Unit::torque : Unit::force;
  if (parts[2] == "position" || parts[2] == "velocity") {
    const Drive::Mode mode = parts[2] == "position" ? Drive::Mode::position : Drive::Mode::velocity;
    if (!is_driven(joint) || joint.drive.mode != mode)
      throw UsageError(place + " commands the " + parts[2] + " of the joint `" + parts[1] +
                       "`, but the scene gives it no drive of the mode " + parts[2]);
    unit = mode == Drive::Mode::position ? (turns ? Unit::angle : Unit::length)
                                         : (turns ? Unit::angular_speed : Unit::speed);
  } else if (parts[2] == "torque" || parts[2] == "force" || parts[2] == "effort") {
    if (joint.drive.mode != Drive::Mode::torque) {
      joint.drive = Drive{};
      joint.drive.mode = Drive::Mode::torque;
      joint.drive.compensates_gravity = false;
    }
  } else {
    throw UsageError(place + ": a joint's position, velocity or torque can be commanded, not its `" + parts[2] + "`");
  }
  inputs.joints.push_back({j, input.columns[0], factor_of(input.unit, unit, place)});
}

void resolve_body_input(Scene& scene, const RecordedInput& input, const std::array<std::string, 3>& parts,
                        const std::string& place, Inputs& inputs) {
  const int b = index_of(scene.rigid_bodies, parts[1]);
  if (b < 0) throw UsageError(place + " names the body `" + parts[1] + "`, which is no rigid body of the scene");
  if (!scene.rigid_bodies[std::size_t(b)].is_prescribed)
    throw UsageError(place + ": the body `" + parts[1] + "` must be of the kind `moving` to go as the input says");
  auto known =
      std::find_if(inputs.bodies.begin(), inputs.bodies.end(), [&](const BodyInput& x) { return x.rigid == b; });
  if (known == inputs.bodies.end()) known = inputs.bodies.insert(inputs.bodies.end(), BodyInput{b, {}, {}, 1});
  const bool turns = parts[2] == "orientation";
  if (!turns && parts[2] != "position")
    throw UsageError(place + ": a body's position or orientation can be prescribed, not its `" + parts[2] + "`");
  if (input.columns.size() != (turns ? 4u : 3u))
    throw UsageError(place + " must name " + (turns ? "4 columns, x y z w" : "3 columns"));
  (turns ? known->orientation : known->position) = input.columns;
  if (!turns) known->to_si = factor_of(input.unit, Unit::length, place);
}

// Also sets the drives' modes.
Inputs resolve_inputs(Problem& problem) {
  Inputs inputs;
  for (std::size_t i = 0; i < problem.recording.inputs.size(); ++i) {
    const RecordedInput& input = problem.recording.inputs[i];
    const std::string place = problem.recording.file.string() + ": inputs[" + std::to_string(i) + "]";
    const std::array<std::string, 3> parts = parts_of(input.target, place);
    if (parts[0] == "joint")
      resolve_joint_input(problem.scene.scene, input, parts, place, inputs);
    else if (parts[0] == "body")
      resolve_body_input(problem.scene.scene, input, parts, place, inputs);
    else
      throw UsageError(place + ": `target` must begin with joint/ or body/, but is `" + input.target + "`");
  }
  return inputs;
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
    run.values.push_back(std::move(values));
  }
  const Scene& scene = problem.scene.scene;
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

bool may_move(const RigidBody& body) { return !body.is_fixed && !body.is_prescribed; }

// Joints in an order in which parents come first; what closes a loop is left out.
void find_coordinates(Problem& problem) {
  const Scene& scene = problem.scene.scene;
  std::vector<char> is_child(scene.rigid_bodies.size()), is_placed(scene.rigid_bodies.size());
  for (const Joint& joint : scene.joints) is_child[std::size_t(joint.child)] = true;
  for (std::size_t b = 0; b < is_placed.size(); ++b) {
    is_placed[b] = !is_child[b] || !may_move(scene.rigid_bodies[b]);
    if (is_placed[b] && may_move(scene.rigid_bodies[b])) problem.free_bodies.push_back(int(b));
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
    return c.kind == Kind::position && (of_joint ? c.joint : c.rigid) == index;
  });
}

bool can_restart(const Problem& problem) {
  const Scene& scene = problem.scene.scene;
  if (!scene.soft_bodies.empty() || !scene.cloths.empty()) return false;
  if (problem.recording.initial == Recording::Initial::given) return false;
  for (const int j : problem.coordinates) {
    const Joint& joint = scene.joints[std::size_t(j)];
    if (joint.type == Joint::Type::spherical) return false;
    if (has_coordinate(joint) && !is_measured(problem, true, j)) return false;
  }
  for (const int b : problem.free_bodies)
    if (!is_measured(problem, false, b)) return false;
  return true;
}

void check_given(const Problem& problem) {
  for (const auto& [key, value] : problem.recording.given) {
    const std::array<std::string, 3> parts = parts_of(key, problem.recording.file.string() + ": `initial`");
    const int j = parts[0] == "joint" ? index_of(problem.scene.scene.joints, parts[1]) : -1;
    if (j < 0 || (parts[2] != "position" && parts[2] != "velocity"))
      throw UsageError(problem.recording.file.string() + ": `initial." + key +
                       "` must be joint/NAME/position or joint/NAME/velocity of a joint of the scene");
  }
}

// At least one channel must be of something that can move, and change.
void check_motion(const Problem& problem) {
  const Scene& scene = problem.scene.scene;
  bool any_moves = false, any_changes = false;
  for (std::size_t c = 0; c < problem.channels.size(); ++c) {
    const Channel& channel = problem.channels[c];
    any_moves = any_moves || channel.rigid < 0 || may_move(scene.rigid_bodies[std::size_t(channel.rigid)]);
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

Problem make_problem(const std::filesystem::path& path) {
  Problem problem;
  problem.recording = load_recording(path);
  problem.scene = load_scene_run(problem.recording.scene);
  Scene& scene = problem.scene.scene;
  std::vector<TargetTable> of_joint(scene.joints.size(), TargetTable{{0}, {0}});
  for (std::size_t j = 0, driven = 0; j < scene.joints.size(); ++j)
    if (is_driven(scene.joints[j])) of_joint[j] = problem.scene.targets[driven++];
  const Inputs inputs = resolve_inputs(problem);
  std::vector<double> to_si;
  for (std::size_t c = 0; c < problem.recording.channels.size(); ++c) {
    Resolved resolved = resolve(problem, c);
    problem.channels.push_back(std::move(resolved.channel));
    to_si.push_back(resolved.to_si);
  }
  for (const RecordedRun& run : problem.recording.runs)
    problem.runs.push_back(make_run(problem, run, to_si, inputs, of_joint));
  find_coordinates(problem);
  problem.can_restart = can_restart(problem);
  check_given(problem);
  check_motion(problem);
  return problem;
}

std::vector<std::string> warnings(const Problem& problem) {
  std::vector<std::string> sentences;
  const std::size_t n_held_out = std::size_t(
      std::count_if(problem.runs.begin(), problem.runs.end(), [](const Run& run) { return run.is_held_out; }));
  if (n_held_out == 0)
    sentences.push_back(
        "no run is held out: nothing can be proved on data that the fit has not seen, and no effect will be named; "
        "give one run, of another motion, the role `held_out`");
  if (n_held_out == problem.runs.size())
    sentences.push_back("every run is held out: there is nothing to fit; give at least one run the role `fit`");
  if (problem.runs.size() == 1)
    sentences.push_back("there is one run only; two effects that look alike in it cannot be told apart");
  for (std::size_t c = 0; c < problem.channels.size(); ++c) {
    std::size_t gaps = 0, all = 0;
    bool changes = false;
    for (const Run& run : problem.runs) {
      double first = std::nan("");
      for (std::size_t i = 0; i < run.values[c].size(); ++i, ++all) {
        if (!std::isfinite(run.values[c][i])) {
          ++gaps;
          continue;
        }
        if (i % std::size_t(problem.channels[c].width) == 0) {
          if (!std::isfinite(first)) first = run.values[c][i];
          changes = changes || run.values[c][i] != first;
        }
      }
    }
    if (10 * gaps > all)
      sentences.push_back("the " + problem.channels[c].name + " has gaps in " + std::to_string(100 * gaps / all) +
                          " % of its samples");
    if (!changes && problem.channels[c].width == 1)
      sentences.push_back("the " + problem.channels[c].name + " is constant");
  }
  for (const Run& run : problem.runs) {
    double longest = 0, shortest = INFINITY;
    for (std::size_t i = 1; i < run.t.size(); ++i) {
      longest = std::max(longest, run.t[i] - run.t[i - 1]);
      shortest = std::min(shortest, run.t[i] - run.t[i - 1]);
    }
    if (longest > 20 * (run.t.back() - run.t.front()) / double(run.t.size()))
      sentences.push_back(run.name + " has a gap of " + std::to_string(longest) + " s in its clock");
    if (problem.scene.scene.solver.time_step > 0.25 * (run.t.back() - run.t.front()))
      sentences.push_back(run.name + " is shorter than four time steps of the scene");
  }
  return sentences;
}

}  // namespace pvg::diagnose
