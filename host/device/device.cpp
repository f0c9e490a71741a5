#include <algorithm>
#include <numeric>
#include <utility>

#include "host/device/choose_device.hpp"
#include "host/device/find_devices.hpp"
#include "host/device/opencl_error.hpp"

namespace pvg {

Device::Device(const std::string& which, Purpose purpose) : impl_(std::make_unique<Impl>()) {
  const std::vector<FoundDevice> devices = find_devices();
  std::vector<DeviceInfo> infos;
  for (const FoundDevice& found : devices) infos.push_back(found.info);
  const FoundDevice& device = devices.at(choose_device(infos, which, purpose).index);
  impl_->info = device.info;
  impl_->id = device.id;
  cl_int code = 0;
  impl_->context = clCreateContext(nullptr, 1, &device.id, nullptr, nullptr, &code);
  require(code, "open device " + device.info.name);
  impl_->queue = clCreateCommandQueue(impl_->context, device.id, 0, &code);
  require(code, "open a queue on device " + device.info.name);
  if (!platform_keeps_programs(device.info.platform)) impl_->cache = ProgramCache(program_cache_folder());
}
Device::~Device() = default;
Device::Device(Device&&) noexcept = default;
const DeviceInfo& Device::info() const { return impl_->info; }
void Device::finish() {
  const std::size_t staged = impl_->staged_so_far();
  ++impl_->n_waits;
  impl_->count("wait for all", "");
  require(clFinish(impl_->queue), "wait for the device");
  impl_->forget_staged(staged);
}
namespace {

// What a host function is given by the driver: the driver copies it and puts the addresses of the memory in.
struct HostCall {
  static constexpr std::size_t MOST = 8;
  Device::HostTask* task;
  std::size_t n;
  void* memory[MOST];
};

void CL_CALLBACK run_host_call(void* argument) {
  auto* call = static_cast<HostCall*>(argument);
  const std::unique_ptr<Device::HostTask> task(call->task);
  (*task)(std::span<void* const>(call->memory, call->n));
}

}  // namespace

void Device::call(std::vector<detail::HostAccess> access, HostTask task) {
  if (access.size() > HostCall::MOST) throw std::logic_error("a host function was given too many buffers");
  if (!info().runs_host_functions) {
    std::vector<std::vector<unsigned char>> numbers;
    std::vector<void*> memory;
    for (const detail::HostAccess& each : access) {
      memory.push_back(numbers.emplace_back(each.bytes).data());
      if (each.is_read && each.bytes > 0) each.memory->read_later(memory.back(), 0, each.bytes);
    }
    finish();
    task(memory);
    for (std::size_t i = 0; i < access.size(); ++i)
      if (access[i].is_written && access[i].bytes > 0) access[i].memory->write(memory[i], 0, access[i].bytes);
    return;
  }
  HostCall call{new HostTask(std::move(task)), access.size(), {}};
  // PoCL 3.1 sorts the buffers as they were made, and leaves their places as they were
  std::vector<std::size_t> order(access.size());
  std::iota(order.begin(), order.end(), std::size_t(0));
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return access[a].memory->serial() < access[b].memory->serial(); });
  std::vector<cl_mem> buffers;
  std::vector<const void*> places;
  for (const std::size_t i : order) {
    buffers.push_back(*static_cast<const cl_mem*>(access[i].memory->handle()));
    places.push_back(&call.memory[i]);
  }
  ++impl_->n_launches;
  impl_->count("host function", "");
  const cl_int code = clEnqueueNativeKernel(impl_->queue, run_host_call, &call, sizeof call, cl_uint(buffers.size()),
                                            buffers.data(), places.data(), 0, nullptr, nullptr);
  if (code == CL_SUCCESS) return;
  delete call.task;
  require(code, "call a host function");
}

std::size_t Device::peak_bytes() const { return impl_->peak_bytes; }
DeviceCounts Device::counts() const { return {impl_->n_launches, impl_->n_writes, impl_->n_waits, impl_->n_bytes}; }
void Device::count_by_name() { impl_->counts_names = true; }
DeviceCountsByName Device::counts_by_name() const {
  const std::lock_guard lock(impl_->counting);
  return impl_->by_name;
}
DeviceCounts& DeviceCounts::operator+=(const DeviceCounts& other) {
  launches += other.launches, writes += other.writes, waits += other.waits, bytes += other.bytes;
  return *this;
}
DeviceCounts DeviceCounts::operator-(const DeviceCounts& other) const {
  return {launches - other.launches, writes - other.writes, waits - other.waits, bytes - other.bytes};
}
void Device::keep_programs_in(const std::string& folder) { impl_->cache = ProgramCache(folder); }
std::size_t Device::n_compiled() const { return impl_->n_compiled; }

}  // namespace pvg
