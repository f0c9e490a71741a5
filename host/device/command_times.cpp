#include "host/device/command_times.hpp"

#include "host/device/impl.hpp"
#include "host/device/opencl_error.hpp"

namespace pvg {

void time_commands(Device& device) {
  device.finish();
  Device::Impl& impl = device.impl();
  cl_int code = 0;
  const cl_command_queue queue = clCreateCommandQueue(impl.context, impl.id, CL_QUEUE_PROFILING_ENABLE, &code);
  require(code, "open a queue that tells times on device " + impl.info.name);
  clReleaseCommandQueue(impl.queue);
  impl.queue = queue;
  impl.times_commands = true;
}

std::map<std::string, CommandTime> take_command_times(Device& device) {
  device.finish();
  Device::Impl& impl = device.impl();
  const std::lock_guard lock(impl.timing);
  std::map<std::string, CommandTime> times;
  for (const auto& [name, event] : impl.timed) {
    if (!event) continue;         // the command was refused
    cl_ulong begin = 0, end = 0;  // [ns]
    require(clGetEventProfilingInfo(event, CL_PROFILING_COMMAND_START, sizeof begin, &begin, nullptr), "time " + name);
    require(clGetEventProfilingInfo(event, CL_PROFILING_COMMAND_END, sizeof end, &end, nullptr), "time " + name);
    CommandTime& all = times[name];
    ++all.times;
    all.seconds += 1e-9 * double(end - begin);
    clReleaseEvent(event);
  }
  impl.timed.clear();
  return times;
}

}  // namespace pvg
