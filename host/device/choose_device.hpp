// Which of the devices found is used: apart from the driver, so that every case can be tested.
#pragma once
#include <string>
#include <vector>

#include "host/device/device.hpp"

namespace pvg {

// As Device's constructor says; `option` named the device.
const DeviceInfo& choose_device(const std::vector<DeviceInfo>& devices, const std::string& which,
                                Purpose purpose = Purpose::physics, const std::string& option = "--device");

// The one that renders beside another that simulates. Where neither is named: the second of two GPUs of the same name
// and driver, so that both work at once and an episode's bits stay the same; a GPU without double precision beside a
// CPU that simulates; else `render`, or `physics` where that is empty.
const DeviceInfo& choose_render_device(const std::vector<DeviceInfo>& devices, const std::string& physics,
                                       const std::string& render);

}  // namespace pvg
