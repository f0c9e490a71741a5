#include <algorithm>
#include <numeric>
#include <utility>

#include "host/device/choose_device.hpp"
#include "host/device/find_devices.hpp"
#include "host/device/opencl_error.hpp"

namespace pvg {
namespace {

std::unique_ptr<Device::Impl> find_impl(const std::string& which, Purpose purpose) {
  const std::vector<FoundDevice> devices = find_devices();
  std::vector<DeviceInfo> infos;
  for (const FoundDevice& found : devices) infos.push_back(found.info);
  const FoundDevice& device = devices.at(choose_device(infos, which, purpose).index);
  auto impl = std::make_unique<Device::Impl>();
  impl->info = device.info;
  impl->id = device.id;
  return impl;
}

}  // namespace

Device::Device(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {
  const DeviceInfo& info = impl_->info;
  cl_int code = 0;
  impl_->context = clCreateContext(nullptr, 1, &impl_->id, nullptr, nullptr, &code);
  require(code, "open device " + info.name);
  impl_->queue = clCreateCommandQueue(impl_->context, impl_->id, 0, &code);
  require(code, "open a queue on device " + info.name);
  if (!platform_keeps_programs(info.platform)) impl_->cache = ProgramCache(program_cache_folder());
}
Device::Device(const std::string& which, Purpose purpose) : Device(find_impl(which, purpose)) {}
Device::~Device() = default;
Device::Device(Device&&) noexcept = default;
const DeviceInfo& Device::info() const { return impl_->info; }
std::vector<Device> Device::compute_units() const {
  if (info().is_gpu || info().compute_units < 2) return {};
  const cl_device_partition_property each[] = {CL_DEVICE_PARTITION_EQUALLY, 1, 0};
  std::vector<cl_device_id> ids(info().compute_units);
  cl_uint n = 0;
  if (clCreateSubDevices(impl_->id, each, cl_uint(ids.size()), ids.data(), &n) != CL_SUCCESS) return {};
  std::vector<Device> units;
  for (cl_uint i = 0; i < n; ++i) {
    auto impl = std::make_unique<Impl>();
    impl->info = info();
    impl->info.compute_units = 1;
    impl->id = ids[i];
    impl->is_part = true;
    units.push_back(Device(std::move(impl)));
  }
  return units;
}
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
