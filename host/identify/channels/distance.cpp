// The distance between two points, each of a rigid body.
#include "host/base/error.hpp"
#include "host/identify/channels/prediction.hpp"
#include "host/identify/channels/resolve.hpp"
#include "host/model/world_state.hpp"

namespace pvg::diagnose {
namespace {

Resolved resolve(const ChannelPlace& where, const RecordedChannel& recorded) {
  Channel channel = find_subject(where, recorded);
  require_rigid(where, recorded, channel);
  if (recorded.point) channel.point = *recorded.point;
  channel.other = index_named(where.scene.rigid_bodies, recorded.other_body);
  channel.other_point = recorded.other_point;
  if (channel.other < 0)
    throw UsageError(where.entry + ": `to` names the body `" + recorded.other_body +
                     "`, which is no rigid body of the scene");
  channel.name += " to " + recorded.other_body;
  return measured_in(where, recorded, channel, Unit::length);
}

std::vector<double> predict(const Channel& channel, const Look& look) {
  const AffineMap& other = look.state.rigid[std::size_t(channel.other)];
  const Vec3 end = other.leftCols<3>() * channel.other_point + other.col(3);
  return sensed(look, (1 + look.sensing.length_scale) * (point_of(channel, look) - end).norm());
}

}  // namespace

constinit const SensorKind distance_sensor = {.kind = ChannelKind::distance,
                                              .resolve = resolve,
                                              .predict = predict,
                                              .interpolate = cubic_value,
                                              .difference = plain_difference,
                                              .is_length = true,
                                              .has_mounting_place = true,
                                              .takes_bias = true};

}  // namespace pvg::diagnose
