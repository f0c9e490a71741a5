#include <functional>
#include <stdexcept>
#include <utility>

#include "host/base/error.hpp"
#include "host/identify/data/embedded_point.hpp"
#include "host/identify/data/resolve.hpp"

namespace pvg::diagnose {
namespace {

using Kind = RecordedChannel::Kind;

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

void find_body(const Scene& scene, const RecordedChannel& recorded, const std::string& place, Channel& channel) {
  channel.rigid = index_named(scene.rigid_bodies, recorded.body);
  channel.soft = index_named(scene.soft_bodies, recorded.body);
  channel.cloth = index_named(scene.cloths, recorded.body);
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

namespace {

// The scene must have that camera, and its pictures the size of what was measured, of a run: width and height.
void check_camera(const Problem& problem, const std::string& name, const std::string& place, const std::string& what,
                  const std::function<std::pair<int, int>(const RecordedRun&)>& size_of) {
  const int camera = index_named(problem.seen.cameras, name);
  if (camera < 0) throw UsageError(place + " names the camera `" + name + "`, which the scene does not have");
  const Camera& optics = problem.seen.cameras[std::size_t(camera)];
  for (const RecordedRun& run : problem.recording.runs) {
    const auto [width, height] = size_of(run);
    if (width != optics.width || height != optics.height)
      throw UsageError(place + ": the " + what + " of " + run.name + " are " + std::to_string(width) + " x " +
                       std::to_string(height) + " pixels, the camera `" + name + "` makes pictures of " +
                       std::to_string(optics.width) + " x " + std::to_string(optics.height) +
                       "; give the camera the measured size");
  }
}

// the camera and the part of a mask, which the first body of that name stands for
Channel resolve_mask(const Problem& problem, const RecordedChannel& recorded, const std::string& place) {
  const MaskSource& source = problem.recording.mask_sources[std::size_t(recorded.mask_source)];
  check_camera(problem, source.camera, place, "masks", [&](const RecordedRun& run) {
    const PartMasks& masks = run.masks[std::size_t(recorded.mask_source)].masks;
    return std::pair(masks.width, masks.height);
  });
  Channel channel;
  channel.kind = Kind::mask;
  channel.mask_source = recorded.mask_source;
  channel.moment = recorded.moment;
  channel.name = recorded.columns[0];
  channel.subject = source.part;
  channel.unit = "1";
  std::string known;
  for (const Visual& visual : problem.seen.visuals) {
    if (visual.part == source.part) {
      channel.rigid = visual.rigid;
      channel.soft = visual.soft;
      channel.cloth = visual.cloth;
      return channel;
    }
    if (known.find(visual.part) == std::string::npos) known += (known.empty() ? "" : ", ") + visual.part;
  }
  throw UsageError(place + " names the part `" + source.part + "`, which the scene does not have; " +
                   (known.empty() ? "none of its bodies is shown: give them `visuals`" : "it has: " + known));
}

// a cell of a camera's pictures
Channel resolve_video(const Problem& problem, const RecordedChannel& recorded, const std::string& place) {
  const VideoSource& source = problem.recording.video_sources[std::size_t(recorded.video_source)];
  check_camera(problem, source.camera, place, "pictures", [&](const RecordedRun& run) {
    const RecordedVideo& video = run.videos[std::size_t(recorded.video_source)];
    return std::pair(video.width, video.height);
  });
  Channel channel;
  channel.kind = Kind::video;
  channel.video_source = recorded.video_source;
  channel.cell = recorded.cell;
  channel.name = recorded.columns[0];
  channel.subject = "what " + source.camera + " sees";
  channel.unit = "1";
  channel.is_noise_known = recorded.noise > 0;
  channel.sigma = channel.is_noise_known ? recorded.noise : 0;
  return channel;
}

}  // namespace

Resolved resolve_channel(const Problem& problem, std::size_t number) {
  const Scene& scene = problem.scene.scene;
  const RecordedChannel& recorded = problem.recording.channels[number];
  const std::string place = problem.recording.file.string() + ": channels[" + std::to_string(number) + "]";
  Resolved resolved;
  Channel& channel = resolved.channel;
  if (recorded.kind == Kind::mask) {
    channel = resolve_mask(problem, recorded, problem.recording.file.string() + ": a mask");
    return resolved;
  }
  if (recorded.kind == Kind::video) {
    channel = resolve_video(problem, recorded, problem.recording.file.string() + ": a video");
    return resolved;
  }
  channel.kind = recorded.kind;
  bool turns = false;
  if (!recorded.joint.empty()) {
    channel.joint = index_named(scene.joints, recorded.joint);
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

}  // namespace pvg::diagnose
