#include "host/device/choose_device.hpp"
#include "host/device/impl.hpp"
#include "host/device/machine.hpp"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <numeric>
#include <utility>

namespace pvg {
namespace {

std::string code_name(cl_int code) {
  switch (code) {
    case CL_DEVICE_NOT_FOUND:
      return "CL_DEVICE_NOT_FOUND";
    case CL_DEVICE_NOT_AVAILABLE:
      return "CL_DEVICE_NOT_AVAILABLE";
    case CL_MEM_OBJECT_ALLOCATION_FAILURE:
      return "CL_MEM_OBJECT_ALLOCATION_FAILURE";
    case CL_OUT_OF_RESOURCES:
      return "CL_OUT_OF_RESOURCES";
    case CL_OUT_OF_HOST_MEMORY:
      return "CL_OUT_OF_HOST_MEMORY";
    case CL_BUILD_PROGRAM_FAILURE:
      return "CL_BUILD_PROGRAM_FAILURE";
    case CL_INVALID_VALUE:
      return "CL_INVALID_VALUE";
    case CL_INVALID_BUFFER_SIZE:
      return "CL_INVALID_BUFFER_SIZE";
    case CL_INVALID_KERNEL_NAME:
      return "CL_INVALID_KERNEL_NAME";
    case CL_INVALID_ARG_SIZE:
      return "CL_INVALID_ARG_SIZE";
    case CL_INVALID_KERNEL_ARGS:
      return "CL_INVALID_KERNEL_ARGS";
    default:
      return "OpenCL code " + std::to_string(code);
  }
}

void require(cl_int code, const std::string& what) {
  if (code != CL_SUCCESS) throw DeviceError(what + ": the OpenCL driver answered " + code_name(code));
}

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

struct FoundDevice {
  cl_device_id id;
  DeviceInfo info;
};

// PVG_HOST_FUNCTIONS=0 treats every device like one apart from the host, to see what it would be asked for.
bool may_run_host_functions() {
  const char* value = std::getenv("PVG_HOST_FUNCTIONS");
  return !value || std::string(value) != "0";
}

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

std::string lower(std::string text) {
  for (char& c : text) c = char(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

}  // namespace

namespace {

// the device that the text names; empty: the first GPU with double precision, for rendering any, else the first device
const DeviceInfo& find_named(const std::vector<DeviceInfo>& devices, const std::string& which, Purpose purpose) {
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
  throw UsageError("--device " + which + " fits none of the " + std::to_string(devices.size()) +
                   " OpenCL devices; `phyvisgen devices` lists them");
}

}  // namespace

const DeviceInfo& choose_device(const std::vector<DeviceInfo>& devices, const std::string& which, Purpose purpose) {
  if (devices.empty())
    throw UsageError(
        "no OpenCL device was found: install a driver (pocl-opencl-icd for the CPU), then try `phyvisgen devices`");
  const DeviceInfo& device = find_named(devices, which, purpose);
  if (purpose == Purpose::physics && !device.has_fp64)
    throw UsageError(
        "device " + device.name +
        " has no double precision (cl_khr_fp64), which the contact solver needs; choose another with --device");
  return device;
}

const DeviceInfo& choose_render_device(const std::vector<DeviceInfo>& devices, const std::string& physics,
                                       const std::string& render) {
  const DeviceInfo& simulates = choose_device(devices, physics);
  if (!render.empty()) return choose_device(devices, render, Purpose::rendering);
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

std::vector<DeviceInfo> list_devices() {
  std::vector<DeviceInfo> infos;
  for (const FoundDevice& device : find_devices()) infos.push_back(device.info);
  return infos;
}

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
  const cl_int code = clEnqueueNativeKernel(impl_->queue, run_host_call, &call, sizeof call, cl_uint(buffers.size()),
                                            buffers.data(), places.data(), 0, nullptr, nullptr);
  if (code == CL_SUCCESS) return;
  delete call.task;
  require(code, "call a host function");
}

std::size_t Device::peak_bytes() const { return impl_->peak_bytes; }
DeviceCounts Device::counts() const { return {impl_->n_launches, impl_->n_writes, impl_->n_waits, impl_->n_bytes}; }
DeviceCounts& DeviceCounts::operator+=(const DeviceCounts& other) {
  launches += other.launches, writes += other.writes, waits += other.waits, bytes += other.bytes;
  return *this;
}
DeviceCounts DeviceCounts::operator-(const DeviceCounts& other) const {
  return {launches - other.launches, writes - other.writes, waits - other.waits, bytes - other.bytes};
}
void Device::keep_programs_in(const std::string& folder) { impl_->cache = ProgramCache(folder); }
std::size_t Device::n_compiled() const { return impl_->n_compiled; }

namespace detail {
namespace {
// Bytes; copying more takes longer than waiting, which is dearer where the device is apart from the host.
constexpr std::size_t LARGEST_STAGED = 1 << 17, LARGEST_STAGED_APART = 1 << 22;
constexpr std::size_t MOST_STAGED = 256;  // writes
}  // namespace

void throw_size_mismatch(const std::string& name, std::size_t has, std::size_t given) {
  throw std::logic_error("buffer " + name + " has " + std::to_string(has) + " elements, was given " +
                         std::to_string(given));
}

Memory::Memory(Device& device, std::size_t bytes, std::string name)
    : device_(&device), bytes_(bytes), name_(std::move(name)) {
  cl_int code = 0;
  handle_ = clCreateBuffer(device.impl().context, CL_MEM_READ_WRITE, bytes, nullptr, &code);
  require(code, "allocate " + name_ + ", " + std::to_string(bytes) + " bytes");
  Device::Impl& impl = device.impl();
  serial_ = ++impl.n_buffers;
  const std::size_t live = impl.live_bytes += bytes;
  std::size_t peak = impl.peak_bytes;
  while (peak < live && !impl.peak_bytes.compare_exchange_weak(peak, live)) {
  }
}

Memory::~Memory() {
  if (!handle_) return;
  clReleaseMemObject(static_cast<cl_mem>(handle_));
  device_->impl().live_bytes -= bytes_;
}

Memory::Memory(Memory&& other) noexcept
    : device_(other.device_),
      handle_(std::exchange(other.handle_, nullptr)),
      bytes_(other.bytes_),
      serial_(other.serial_),
      name_(other.name_) {}

Memory& Memory::operator=(Memory&& other) noexcept {
  std::swap(device_, other.device_);
  std::swap(handle_, other.handle_);
  std::swap(bytes_, other.bytes_);
  std::swap(serial_, other.serial_);
  std::swap(name_, other.name_);
  return *this;
}

void Memory::write(const void* from, std::size_t offset, std::size_t bytes) {
  Device::Impl& impl = device_->impl();
  impl.n_bytes += bytes;
  const auto enqueue = [&](const void* source, cl_bool waits) {
    require(clEnqueueWriteBuffer(impl.queue, static_cast<cl_mem>(handle_), waits, offset, bytes, source, 0, nullptr,
                                 nullptr),
            "write " + name_);
  };
  if (bytes > (impl.info.runs_host_functions ? LARGEST_STAGED : LARGEST_STAGED_APART)) {
    ++impl.n_waits;
    return enqueue(from, CL_TRUE);
  }
  ++impl.n_writes;
  {
    const std::lock_guard lock(impl.staging);
    const auto* first = static_cast<const unsigned char*>(from);
    impl.staged.push_back({impl.n_staged++, {first, first + bytes}});
    enqueue(impl.staged.back().bytes.data(), CL_FALSE);
    if (impl.staged.size() < MOST_STAGED) return;
  }
  device_->finish();
}

void Memory::read(void* to, std::size_t offset, std::size_t bytes) const {
  Device::Impl& impl = device_->impl();
  impl.n_bytes += bytes;
  ++impl.n_waits;
  const std::size_t staged = impl.staged_so_far();
  require(
      clEnqueueReadBuffer(impl.queue, static_cast<cl_mem>(handle_), CL_TRUE, offset, bytes, to, 0, nullptr, nullptr),
      "read " + name_);
  impl.forget_staged(staged);
}

void Memory::read_later(void* to, std::size_t offset, std::size_t bytes) const {
  device_->impl().n_bytes += bytes;
  require(clEnqueueReadBuffer(device_->impl().queue, static_cast<cl_mem>(handle_), CL_FALSE, offset, bytes, to, 0,
                              nullptr, nullptr),
          "read " + name_);
}

void Memory::fill_zero(std::size_t bytes) {
  const cl_uchar zero = 0;
  ++device_->impl().n_launches;
  require(
      clEnqueueFillBuffer(device_->impl().queue, static_cast<cl_mem>(handle_), &zero, 1, 0, bytes, 0, nullptr, nullptr),
      "clear " + name_);
}

void Memory::copy_from(const Memory& other, std::size_t bytes) {
  ++device_->impl().n_launches;
  require(clEnqueueCopyBuffer(device_->impl().queue, static_cast<cl_mem>(other.handle_), static_cast<cl_mem>(handle_),
                              0, 0, bytes, 0, nullptr, nullptr),
          "copy " + other.name_ + " to " + name_);
}

}  // namespace detail

namespace {

// empty where the driver does not tell all of them
std::vector<std::string> argument_names(cl_kernel kernel, unsigned n) {
  std::vector<std::string> names;
  for (unsigned i = 0; i < n; ++i) {
    std::size_t size = 0;
    if (clGetKernelArgInfo(kernel, i, CL_KERNEL_ARG_NAME, 0, nullptr, &size) != CL_SUCCESS || size == 0) return {};
    std::string name(size, 0);
    if (clGetKernelArgInfo(kernel, i, CL_KERNEL_ARG_NAME, size, name.data(), nullptr) != CL_SUCCESS) return {};
    name.resize(size - 1);  // the terminating zero
    names.push_back(std::move(name));
  }
  return names;
}

}  // namespace

Kernel::Kernel(Device& device, void* program, const std::string& name) : device_(&device), name_(name) {
  cl_int code = 0;
  handle_ = clCreateKernel(static_cast<cl_program>(program), name.c_str(), &code);
  require(code, "make kernel " + name);
  require(
      clGetKernelInfo(static_cast<cl_kernel>(handle_), CL_KERNEL_NUM_ARGS, sizeof n_arguments_, &n_arguments_, nullptr),
      "ask kernel " + name + " for its arguments");
  given_.resize(n_arguments_);
  argument_names_ = argument_names(static_cast<cl_kernel>(handle_), n_arguments_);
  buffer_names_.resize(n_arguments_);
}
Kernel::~Kernel() {
  if (handle_) clReleaseKernel(static_cast<cl_kernel>(handle_));
}
Kernel::Kernel(Kernel&& other) noexcept
    : device_(other.device_),
      handle_(std::exchange(other.handle_, nullptr)),
      name_(other.name_),
      n_arguments_(other.n_arguments_),
      argument_names_(std::move(other.argument_names_)),
      buffer_names_(std::move(other.buffer_names_)),
      has_new_names_(other.has_new_names_),
      given_(std::move(other.given_)) {}

void Kernel::begin(std::size_t n_arguments) {
  if (n_arguments != n_arguments_)
    throw std::logic_error("kernel " + name_ + " takes " + std::to_string(n_arguments_) + " arguments, was given " +
                           std::to_string(n_arguments));
}
bool Kernel::is_known(unsigned i, const void* value, std::size_t bytes) {
  std::vector<unsigned char>& given = given_[i];
  if (given.size() == bytes && std::memcmp(given.data(), value, bytes) == 0) return true;
  const auto* first = static_cast<const unsigned char*>(value);
  given.assign(first, first + bytes);
  return false;
}
void Kernel::check_names() const {
  for (std::size_t i = 0; i < argument_names_.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      if (buffer_names_[i] == argument_names_[j] && buffer_names_[j] == argument_names_[i])
        throw std::logic_error("kernel " + name_ + ": argument " + argument_names_[j] + " was given buffer " +
                               buffer_names_[j] + ", and " + argument_names_[i] + " buffer " + buffer_names_[i]);
}
void Kernel::set_memory(unsigned i, const detail::Memory& memory) {
  const std::size_t serial = memory.serial();
  if (is_known(i, &serial, sizeof serial)) return;
  buffer_names_[i] = memory.name();
  has_new_names_ = true;
  const cl_int code = clSetKernelArg(static_cast<cl_kernel>(handle_), i, sizeof(cl_mem), memory.handle());
  if (code != CL_SUCCESS)  // the message only where it is needed: this is called for each launch
    require(code, "give " + memory.name() + " to kernel " + name_ + " as argument " + std::to_string(i));
}
void Kernel::set_bytes(unsigned i, const void* value, std::size_t bytes) {
  if (is_known(i, value, bytes)) return;
  const cl_int code = clSetKernelArg(static_cast<cl_kernel>(handle_), i, bytes, value);
  if (code != CL_SUCCESS) require(code, "give a value to kernel " + name_ + " as argument " + std::to_string(i));
}
void Kernel::launch(std::size_t n) {
  if (std::exchange(has_new_names_, false)) check_names();
  ++device_->impl().n_launches;
  const std::size_t local = GROUP_SIZE, global = (n + local - 1) / local * local;
  const cl_int code = clEnqueueNDRangeKernel(device_->impl().queue, static_cast<cl_kernel>(handle_), 1, nullptr,
                                             &global, &local, 0, nullptr, nullptr);
  if (code != CL_SUCCESS) require(code, "run kernel " + name_);
}

}  // namespace pvg
