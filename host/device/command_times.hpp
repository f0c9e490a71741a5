// How long a device is at work on each kernel, fill, copy, read and write, by the events of its driver. A measurement:
// the driver keeps an event of every command, which takes the host time.
#pragma once
#include <map>
#include <string>

#include "host/device/device.hpp"

namespace pvg {

struct CommandTime {
  std::size_t times = 0;
  double seconds = 0;  // from the command's start to its end on the device, all times together
};

// From now on; what was started before is waited for. Not while another thread uses the device.
void time_commands(Device& device);

// Since time_commands() or the last call, by kind and name, as in "kernel cg_test"; waits for all that was started.
std::map<std::string, CommandTime> take_command_times(Device& device);

}  // namespace pvg
