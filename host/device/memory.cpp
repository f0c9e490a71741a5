// Buffers on the device: small writes are staged, so that they wait for nothing.
#include <utility>

#include "host/device/opencl_error.hpp"

namespace pvg::detail {
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
  const std::string what = "allocate " + name_ + ", " + std::to_string(bytes) + " bytes";
  if (code == CL_INVALID_BUFFER_SIZE || code == CL_MEM_OBJECT_ALLOCATION_FAILURE || code == CL_OUT_OF_HOST_MEMORY)
    throw OutOfDeviceMemory(what + ": the device has no room for so much");
  require(code, what);
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
                                 impl.timed_event("write of ", name_)),
            "write " + name_);
  };
  if (bytes > (impl.info.runs_host_functions ? LARGEST_STAGED : LARGEST_STAGED_APART)) {
    ++impl.n_waits;
    impl.count("wait for a write of ", name_);
    return enqueue(from, CL_TRUE);
  }
  ++impl.n_writes;
  impl.count("write of ", name_);
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
  impl.count("wait for a read of ", name_);
  const std::size_t staged = impl.staged_so_far();
  require(clEnqueueReadBuffer(impl.queue, static_cast<cl_mem>(handle_), CL_TRUE, offset, bytes, to, 0, nullptr,
                              impl.timed_event("read of ", name_)),
          "read " + name_);
  impl.forget_staged(staged);
}

void Memory::read_later(void* to, std::size_t offset, std::size_t bytes) const {
  device_->impl().n_bytes += bytes;
  require(clEnqueueReadBuffer(device_->impl().queue, static_cast<cl_mem>(handle_), CL_FALSE, offset, bytes, to, 0,
                              nullptr, device_->impl().timed_event("read of ", name_)),
          "read " + name_);
}

void Memory::fill_zero(std::size_t bytes) {
  const cl_uchar zero = 0;
  ++device_->impl().n_launches;
  device_->impl().count("fill of ", name_);
  require(clEnqueueFillBuffer(device_->impl().queue, static_cast<cl_mem>(handle_), &zero, 1, 0, bytes, 0, nullptr,
                              device_->impl().timed_event("fill of ", name_)),
          "clear " + name_);
}

void Memory::copy_from(const Memory& other, std::size_t bytes) {
  ++device_->impl().n_launches;
  device_->impl().count("copy to ", name_);
  require(clEnqueueCopyBuffer(device_->impl().queue, static_cast<cl_mem>(other.handle_), static_cast<cl_mem>(handle_),
                              0, 0, bytes, 0, nullptr, device_->impl().timed_event("copy to ", name_)),
          "copy " + other.name_ + " to " + name_);
}

}  // namespace pvg::detail
