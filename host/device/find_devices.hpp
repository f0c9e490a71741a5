// The OpenCL devices of this machine, asked of their drivers.
#pragma once
#include <vector>

#include "host/device/impl.hpp"

namespace pvg {

struct FoundDevice {
  cl_device_id id;
  DeviceInfo info;
};

// All platforms' devices in the drivers' order; none where no driver answers.
std::vector<FoundDevice> find_devices();

}  // namespace pvg
