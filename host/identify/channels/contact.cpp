// Whether a body is touched, 0 or 1. The simulated reading is 1 - exp(-F / threshold) of the normal forces F, so that
// it changes smoothly with what is fitted.
#include <cmath>

#include "host/base/error.hpp"
#include "host/identify/channels/prediction.hpp"
#include "host/identify/channels/resolve.hpp"
#include "host/model/world_state.hpp"

namespace pvg::diagnose {
namespace {

// as contacts count bodies: rigid ones, soft ones, cloths
int number_of(const PhysicalScene& scene, const std::string& name) {
  const int n_rigid = int(scene.rigid_bodies.size()), n_soft = int(scene.soft_bodies.size());
  if (const int i = index_named(scene.rigid_bodies, name); i >= 0) return i;
  if (const int i = index_named(scene.soft_bodies, name); i >= 0) return n_rigid + i;
  if (const int i = index_named(scene.cloths, name); i >= 0) return n_rigid + n_soft + i;
  return -1;
}

Resolved resolve(const ChannelPlace& where, const RecordedChannel& recorded) {
  Channel channel = find_subject(where, recorded);
  if (!recorded.other_body.empty()) {
    channel.other = number_of(where.scene, recorded.other_body);
    if (channel.other < 0)
      throw UsageError(where.entry + ": `with` names the body `" + recorded.other_body +
                       "`, which the scene does not have");
  }
  channel.constant = recorded.threshold;
  return measured_in(where, recorded, channel, Unit::none);
}

std::vector<double> predict(const Channel& channel, const Look& look) {
  const int body = number_of(look.world, channel.subject);
  double force = 0;
  for (const PairForce& pair : look.state.pair_force) {
    const bool is_first = pair.first == body, is_second = pair.second == body;
    if (!is_first && !is_second) continue;
    if (channel.other >= 0 && (is_first ? pair.second : pair.first) != channel.other) continue;
    force += pair.normal.norm();
  }
  return {1 - std::exp(-force / channel.constant)};
}

}  // namespace

constinit const SensorKind contact_sensor = {.kind = ChannelKind::contact,
                                             .resolve = resolve,
                                             .predict = predict,
                                             .interpolate = cubic_value,
                                             .difference = plain_difference,
                                             .is_known_after_a_step = true};

}  // namespace pvg::diagnose
