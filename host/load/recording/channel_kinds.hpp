// The list of kinds of measured channels. From it follow the enumeration, the names in files and messages, the table of
// keys (channels.cpp) and the table of sensors (host/identify/channels: one file per kind).
#pragma once
#include <cstddef>

// clang-format off
#define PVG_CHANNEL_KINDS(X) \
  X(position) X(rate) X(torque) X(orientation) X(marker) X(force) X(mask) X(video) X(angular_velocity) X(gyroscope) \
  X(accelerometer) X(distance) X(current) X(contact)
// clang-format on

namespace pvg {

#define PVG_ENUMERATOR(name) name,
enum class ChannelKind { PVG_CHANNEL_KINDS(PVG_ENUMERATOR) };
#undef PVG_ENUMERATOR

#define PVG_NAME(name) #name,
inline constexpr const char* CHANNEL_KIND_NAMES[] = {PVG_CHANNEL_KINDS(PVG_NAME)};
#undef PVG_NAME

inline constexpr std::size_t N_CHANNEL_KINDS = sizeof CHANNEL_KIND_NAMES / sizeof CHANNEL_KIND_NAMES[0];

}  // namespace pvg
