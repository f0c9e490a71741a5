// A point of a body in the measurement's frame: a vertex, or a rest position in the body's frame.
#include "host/base/error.hpp"
#include "host/geometry/embedded_point.hpp"
#include "host/identify/channels/prediction.hpp"
#include "host/identify/channels/resolve.hpp"
#include "host/model/world_state.hpp"

namespace pvg::diagnose {
namespace {

void refuse_beyond(const ChannelPlace& where, const RecordedChannel& recorded, std::size_t n_vertices) {
  if (recorded.vertex >= int(n_vertices))
    throw UsageError(where.entry + ": `vertex` is beyond the " + std::to_string(n_vertices) + " of `" + recorded.body +
                     "`");
}

Resolved resolve(const ChannelPlace& where, const RecordedChannel& recorded) {
  Channel channel = find_subject(where, recorded);
  const PhysicalScene& scene = where.scene;
  if (channel.rigid >= 0) {
    const TriangleMesh& mesh = scene.rigid_bodies[std::size_t(channel.rigid)].collision;
    refuse_beyond(where, recorded, mesh.points.size());
    channel.point = recorded.point ? *recorded.point : mesh.points[std::size_t(recorded.vertex)];
    return measured_in(where, recorded, channel, Unit::length);
  }
  refuse_beyond(where, recorded,
                channel.soft >= 0 ? scene.soft_bodies[std::size_t(channel.soft)].mesh.points.size()
                                  : scene.cloths[std::size_t(channel.cloth)].mesh.points.size());
  if (recorded.vertex >= 0)
    channel.nodes = {{std::uint32_t(recorded.vertex), 1.0}};
  else if (channel.soft >= 0)
    channel.nodes = embed(scene.soft_bodies[std::size_t(channel.soft)].mesh, *recorded.point);
  else
    channel.nodes = embed(scene.cloths[std::size_t(channel.cloth)].mesh, *recorded.point);
  return measured_in(where, recorded, channel, Unit::length);
}

std::vector<double> predict(const Channel& channel, const Look& look) {
  return sensed_length(channel, look, point_of(channel, look));
}

}  // namespace

constinit const SensorKind marker_sensor = {.kind = ChannelKind::marker,
                                            .resolve = resolve,
                                            .predict = predict,
                                            .interpolate = cubic_value,
                                            .difference = plain_difference,
                                            .is_length = true,
                                            .has_mounting_place = true,
                                            .takes_bias = true};

}  // namespace pvg::diagnose
