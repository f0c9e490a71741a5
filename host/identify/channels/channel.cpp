#include "host/identify/channels/channel.hpp"

namespace pvg::diagnose {

const SensorKind& sensor_of(ChannelKind kind) {
#define PVG_ADDRESS(name) &name##_sensor,
  static constexpr const SensorKind* SENSORS[] = {PVG_CHANNEL_KINDS(PVG_ADDRESS)};
#undef PVG_ADDRESS
  return *SENSORS[std::size_t(kind)];
}

}  // namespace pvg::diagnose
