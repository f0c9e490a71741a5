// What a Device holds; seen by host/device only.
#pragma once
#define CL_TARGET_OPENCL_VERSION 120
#define CL_USE_DEPRECATED_OPENCL_1_2_APIS
#include <CL/cl.h>

#include "host/device/device.hpp"

namespace pvg {

struct Device::Impl {
  DeviceInfo info;
  cl_device_id id = nullptr;
  cl_context context = nullptr;
  cl_command_queue queue = nullptr;
  std::size_t live_bytes = 0, peak_bytes = 0, transferred_bytes = 0;
  ~Impl() {
    if (queue) clReleaseCommandQueue(queue);
    if (context) clReleaseContext(context);
  }
};

}  // namespace pvg
