#include "host/identify/channels/resolve.hpp"

#include <cmath>
#include <stdexcept>

#include "host/base/error.hpp"

namespace pvg::diagnose {
namespace {

void find_body(const ChannelPlace& where, const RecordedChannel& recorded, Channel& channel) {
  const PhysicalScene& scene = where.scene;
  channel.rigid = index_named(scene.rigid_bodies, recorded.body);
  channel.soft = index_named(scene.soft_bodies, recorded.body);
  channel.cloth = index_named(scene.cloths, recorded.body);
  if (channel.rigid >= 0 || channel.soft >= 0 || channel.cloth >= 0) return;
  std::string known;
  for (const RigidBody& body : scene.rigid_bodies) known += (known.empty() ? "" : ", ") + body.name;
  for (const SoftBody& body : scene.soft_bodies) known += (known.empty() ? "" : ", ") + body.name;
  for (const Cloth& body : scene.cloths) known += (known.empty() ? "" : ", ") + body.name;
  throw UsageError(where.entry + " names the body `" + recorded.body +
                   "`, which the scene does not have; it has: " + known);
}

}  // namespace

bool has_coordinate(const Joint& joint) {
  return joint.type == Joint::Type::revolute || joint.type == Joint::Type::prismatic;
}

double factor_of(const std::string& unit, Unit dimension, const std::string& place) {
  if (unit.empty()) return 1;
  try {
    return parse_quantity("1 " + unit, dimension);
  } catch (const std::invalid_argument& wrong) {
    throw UsageError(place + ": `unit` " + wrong.what());
  }
}

bool is_joint_load(const RecordedChannel& recorded) {
  return !recorded.joint.empty() &&
         (recorded.kind == ChannelKind::force || recorded.columns.size() > 1 || recorded.axis);
}

Channel find_joint_load(const ChannelPlace& where, const RecordedChannel& recorded) {
  const PhysicalScene& scene = where.scene;
  Channel channel;
  channel.joint = index_named(scene.joints, recorded.joint);
  if (channel.joint < 0)
    throw UsageError(where.entry + " names the joint `" + recorded.joint + "`, which the scene does not have");
  const Joint& joint = scene.joints[std::size_t(channel.joint)];
  const bool is_torque = recorded.kind == ChannelKind::torque;
  if (joint.type == Joint::Type::prismatic || (is_torque && joint.type != Joint::Type::fixed))
    throw UsageError(
        where.entry + ": the joint `" + recorded.joint + "` " +
        (joint.type == Joint::Type::prismatic ? "slides" : "turns") + ", so its " + (is_torque ? "torque" : "force") +
        " in three axes cannot be predicted; divide the body where the sensor sits, and join its parts by a "
        "joint of the type fixed" +
        (is_torque ? ", or give one `column`, the drive's effort" : ""));
  channel.subject = scene.rigid_bodies[std::size_t(joint.child)].name;
  channel.name = std::string(kind_name(recorded.kind)) + " in joint " + recorded.joint;
  return channel;
}

Channel find_subject(const ChannelPlace& where, const RecordedChannel& recorded) {
  const PhysicalScene& scene = where.scene;
  Channel channel;
  if (recorded.joint.empty()) {
    find_body(where, recorded, channel);
    channel.subject = recorded.body;
    channel.name = std::string(kind_name(recorded.kind)) + " of " + recorded.body;
    return channel;
  }
  channel.joint = index_named(scene.joints, recorded.joint);
  if (channel.joint < 0)
    throw UsageError(where.entry + " names the joint `" + recorded.joint + "`, which the scene does not have");
  const Joint& joint = scene.joints[std::size_t(channel.joint)];
  if (!has_coordinate(joint))
    throw UsageError(where.entry + ": the joint `" + recorded.joint + "` is fixed or a ball joint and has no position");
  channel.subject = scene.rigid_bodies[std::size_t(joint.child)].name;
  channel.name = std::string(kind_name(recorded.kind)) + " of joint " + recorded.joint;
  return channel;
}

void require_rigid(const ChannelPlace& where, const RecordedChannel& recorded, const Channel& channel) {
  if (channel.joint < 0 && channel.rigid < 0)
    throw UsageError(where.entry + ": `" + recorded.body +
                     "` has no one position or orientation; name a point of it by the kind `" +
                     kind_name(ChannelKind::marker) + "`");
}

bool turns(const ChannelPlace& where, const Channel& channel) {
  return channel.joint >= 0 && where.scene.joints[std::size_t(channel.joint)].type == Joint::Type::revolute;
}

Resolved measured_in(const ChannelPlace& where, const RecordedChannel& recorded, Channel channel, Unit dimension) {
  Resolved resolved{std::move(channel), factor_of(recorded.unit, dimension, where.entry)};
  Channel& c = resolved.channel;
  c.unit = si_unit(dimension);
  c.width = c.trace_width = c.n = int(recorded.columns.size());
  c.has_axis = recorded.axis.has_value();
  if (recorded.axis) c.axis = *recorded.axis;
  if (c.n > 1 || where.recording.channels.size() > 1) c.name += " (" + recorded.columns[0] + ")";
  c.is_noise_known = recorded.noise > 0;
  c.sigma = c.is_noise_known ? recorded.noise * resolved.to_si : 0;
  c.jitter = recorded.clock.jitter;
  const Readout& readout = recorded.readout;
  c.readout = {readout.low_pass, readout.resolution * resolved.to_si, readout.lowest * resolved.to_si,
               readout.highest * resolved.to_si};
  if (c.is_noise_known) c.sigma = std::hypot(c.sigma, rounding_noise(c.readout));
  return resolved;
}

void check_camera(const ChannelPlace& where, const std::string& name, const std::string& what,
                  const std::function<std::pair<int, int>(const RecordedRun&)>& size_of) {
  const int camera = index_named(where.seen.cameras, name);
  if (camera < 0) throw UsageError(where.entry + " names the camera `" + name + "`, which the scene does not have");
  const Camera& optics = where.seen.cameras[std::size_t(camera)];
  for (const RecordedRun& run : where.recording.runs) {
    const auto [width, height] = size_of(run);
    if (width != optics.width || height != optics.height)
      throw UsageError(where.entry + ": the " + what + " of " + run.name + " are " + std::to_string(width) + " x " +
                       std::to_string(height) + " pixels, the camera `" + name + "` makes pictures of " +
                       std::to_string(optics.width) + " x " + std::to_string(optics.height) +
                       "; give the camera the measured size");
  }
}

}  // namespace pvg::diagnose
