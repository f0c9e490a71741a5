#include "host/device/choose_device.hpp"
#include "host/base/counted.hpp"

#include <cctype>

namespace pvg {
namespace {

std::string lower(std::string text) {
  for (char& c : text) c = char(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

// the device that the text names; empty: the first GPU with double precision, for rendering any, else the first device
const DeviceInfo& find_named(const std::vector<DeviceInfo>& devices, const std::string& which, Purpose purpose,
                             const std::string& option) {
  if (which.empty()) {
    for (const DeviceInfo& device : devices)
      if (device.is_gpu && device.has_fp64) return device;
    for (const DeviceInfo& device : devices)
      if (device.is_gpu && purpose == Purpose::rendering) return device;
    return devices.front();
  }
  const bool is_index = which.find_first_not_of("0123456789") == std::string::npos && which.size() < 6;
  for (const DeviceInfo& device : devices)
    if (is_index ? std::stoul(which) == device.index
                 : (which == "gpu" && device.is_gpu) || (which == "cpu" && !device.is_gpu) ||
                       lower(device.name + " " + device.platform).find(lower(which)) != std::string::npos)
      return device;
  throw UsageError(option + " " + which + " fits none of the " + counted(devices.size(), "OpenCL device") +
                   "; `phyvisgen devices` lists them");
}

}  // namespace

const DeviceInfo& choose_device(const std::vector<DeviceInfo>& devices, const std::string& which, Purpose purpose,
                                const std::string& option) {
  if (devices.empty())
    throw UsageError(
        "no OpenCL device was found: install a driver (pocl-opencl-icd for the CPU), then try `phyvisgen devices`");
  const DeviceInfo& device = find_named(devices, which, purpose, option);
  if (purpose == Purpose::physics && !device.has_fp64)
    throw UsageError(
        "device " + device.name +
        " has no double precision (cl_khr_fp64), which the contact solver needs; choose another with --device");
  return device;
}

const DeviceInfo& choose_render_device(const std::vector<DeviceInfo>& devices, const std::string& physics,
                                       const std::string& render) {
  const DeviceInfo& simulates = choose_device(devices, physics);
  if (!render.empty()) return choose_device(devices, render, Purpose::rendering, "--render-device");
  if (!physics.empty()) return simulates;
  if (!simulates.is_gpu) {
    for (const DeviceInfo& device : devices)
      if (device.is_gpu) return device;
    return simulates;
  }
  for (const DeviceInfo& device : devices)
    if (device.index != simulates.index && device.name == simulates.name && device.driver == simulates.driver)
      return device;
  return simulates;
}

}  // namespace pvg
