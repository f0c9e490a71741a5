// Which of the devices found is used: apart from the driver, so that every case can be tested.
#pragma once
#include <string>
#include <vector>

#include "host/device/device.hpp"

namespace pvg {

// As Device's constructor says; throws a UsageError where nothing fits or the choice lacks double precision.
const DeviceInfo& choose_device(const std::vector<DeviceInfo>& devices, const std::string& which);

}  // namespace pvg
