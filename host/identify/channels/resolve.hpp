// What a recording names, found in its scene. Whatever does not fit is a UsageError that names the file, the entry and
// what to do.
#pragma once
#include <functional>
#include <string>
#include <utility>

#include "host/identify/channels/channel.hpp"
#include "host/load/fields/yaml_section.hpp"

namespace pvg::diagnose {

template <class List>
int index_named(const List& list, const std::string& name) {
  for (std::size_t i = 0; i < list.size(); ++i)
    if (list[i].name == name) return int(i);
  return -1;
}

bool has_coordinate(const Joint& joint);

// to SI; an empty unit is SI
double factor_of(const std::string& unit, Unit dimension, const std::string& place);

// The channel with the joint or body that the recording names.
Channel find_subject(const ChannelPlace& where, const RecordedChannel& recorded);

// What a joint transmits is measured, all three axes or parts of it, and not its drive's effort alone.
bool is_joint_load(const RecordedChannel& recorded);

// Its joint; a torque in three axes asks for a fixed one.
Channel find_joint_load(const ChannelPlace& where, const RecordedChannel& recorded);

// Refuses bodies that have no one position or orientation.
void require_rigid(const ChannelPlace& where, const RecordedChannel& recorded, const Channel& channel);

bool turns(const ChannelPlace& where, const Channel& channel);  // of a revolute joint

// The channel with unit, noise, axis and widths of a table's columns.
Resolved measured_in(const ChannelPlace& where, const RecordedChannel& recorded, Channel channel, Unit dimension);

// The scene must have that camera, and its pictures the size of what was measured in a run: width and height.
void check_camera(const ChannelPlace& where, const std::string& camera, const std::string& what,
                  const std::function<std::pair<int, int>(const RecordedRun&)>& size_of);

}  // namespace pvg::diagnose
