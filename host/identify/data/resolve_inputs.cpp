#include <algorithm>

#include "host/base/error.hpp"
#include "host/identify/data/resolve.hpp"

namespace pvg::diagnose {
namespace {

void resolve_joint_input(PhysicalScene& scene, const RecordedInput& input, const std::array<std::string, 3>& parts,
                         const std::string& place, Inputs& inputs) {
  const int j = index_named(scene.joints, parts[1]);
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

void resolve_body_input(PhysicalScene& scene, const RecordedInput& input, const std::array<std::string, 3>& parts,
                        const std::string& place, Inputs& inputs) {
  const int b = index_named(scene.rigid_bodies, parts[1]);
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

}  // namespace

std::array<std::string, 3> parts_of(const std::string& target, const std::string& place) {
  const std::size_t first = target.find('/'), last = target.rfind('/');
  if (first == std::string::npos || first == last)
    throw UsageError(place + ": `target` must be such as joint/NAME/position, but is `" + target + "`");
  return {target.substr(0, first), target.substr(first + 1, last - first - 1), target.substr(last + 1)};
}

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

}  // namespace pvg::diagnose
