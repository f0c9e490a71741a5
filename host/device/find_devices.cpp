#include "host/device/find_devices.hpp"

#include <algorithm>
#include <cstdlib>

#include "host/device/machine.hpp"

namespace pvg {
namespace {

template <class Id, class Query>
std::string text_info(Id id, Query query, unsigned what) {
  std::size_t bytes = 0;
  if (query(id, what, 0, nullptr, &bytes) != CL_SUCCESS || bytes == 0) return "";
  std::string text(bytes, '\0');
  query(id, what, bytes, text.data(), nullptr);
  while (!text.empty() && text.back() == '\0') text.pop_back();
  return text;
}

template <class T>
T number_info(cl_device_id id, unsigned what) {
  T value{};
  clGetDeviceInfo(id, what, sizeof value, &value, nullptr);
  return value;
}

// PVG_HOST_FUNCTIONS=0 treats every device like one apart from the host, to see what it would be asked for.
bool may_run_host_functions() {
  const char* value = std::getenv("PVG_HOST_FUNCTIONS");
  return !value || std::string(value) != "0";
}

}  // namespace

std::vector<FoundDevice> find_devices() {
  find_cache_folder();
  cl_uint n_platforms = 0;
  if (clGetPlatformIDs(0, nullptr, &n_platforms) != CL_SUCCESS) return {};
  std::vector<cl_platform_id> platforms(n_platforms);
  clGetPlatformIDs(n_platforms, platforms.data(), nullptr);
  std::vector<FoundDevice> found;
  for (cl_platform_id platform : platforms) {
    cl_uint n = 0;
    if (clGetDeviceIDs(platform, CL_DEVICE_TYPE_ALL, 0, nullptr, &n) != CL_SUCCESS) continue;
    std::vector<cl_device_id> ids(n);
    clGetDeviceIDs(platform, CL_DEVICE_TYPE_ALL, n, ids.data(), nullptr);
    for (cl_device_id id : ids) {
      DeviceInfo info;
      info.index = found.size();
      info.platform = text_info(platform, clGetPlatformInfo, CL_PLATFORM_NAME);
      info.name = text_info(id, clGetDeviceInfo, CL_DEVICE_NAME);
      info.driver = text_info(id, clGetDeviceInfo, CL_DRIVER_VERSION);
      info.version = text_info(id, clGetDeviceInfo, CL_DEVICE_VERSION);
      info.is_gpu = number_info<cl_device_type>(id, CL_DEVICE_TYPE) & CL_DEVICE_TYPE_GPU;
      info.has_fp64 = text_info(id, clGetDeviceInfo, CL_DEVICE_EXTENSIONS).find("cl_khr_fp64") != std::string::npos;
      info.runs_host_functions =
          may_run_host_functions() && (number_info<cl_device_type>(id, CL_DEVICE_TYPE) & CL_DEVICE_TYPE_CPU) &&
          (number_info<cl_device_exec_capabilities>(id, CL_DEVICE_EXECUTION_CAPABILITIES) & CL_EXEC_NATIVE_KERNEL);
      info.compute_units = number_info<cl_uint>(id, CL_DEVICE_MAX_COMPUTE_UNITS);
      info.memory_bytes = number_info<cl_ulong>(id, CL_DEVICE_GLOBAL_MEM_SIZE);
      // drivers for the CPU name a limit of their own, which may be above what the machine or the container has
      if (!info.is_gpu) info.memory_bytes = std::min<std::uint64_t>(info.memory_bytes, memory_of_machine());
      found.push_back({id, info});
    }
  }
  return found;
}

std::string avx_options([[maybe_unused]] const DeviceInfo& device) {
#if defined(__x86_64__)
  if (!device.is_gpu && device.platform == "Portable Computing Language" && __builtin_cpu_supports("avx"))
    return "-DPVG_X86_AVX";
#endif
  return "";
}

std::vector<DeviceInfo> list_devices() {
  std::vector<DeviceInfo> infos;
  for (const FoundDevice& device : find_devices()) infos.push_back(device.info);
  return infos;
}

}  // namespace pvg
