// The device: a context, an in-order queue, buffers that know their length, kernels that check what they are given.
// This folder is the only place that sees the OpenCL headers; nobody outside says cl:: or cl_.
// Every launch uses groups of 64 work-items, or of as many as the kernel requires (reqd_work_group_size), and a padded
// global size, so no driver recompiles for a new size: a kernel's first act is the bounds test.
#pragma once
#include <cstddef>
#include <functional>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "host/base/error.hpp"

namespace pvg {

constexpr std::size_t GROUP_SIZE = 64;

struct DeviceInfo {
  std::size_t index = 0;  // over all platforms, in the order in which the loader lists them
  std::string platform, name, driver, version;
  bool is_gpu = false, has_fp64 = false;
  bool runs_host_functions = false;  // in the order of its queue, on the memory of the host: a CPU
  unsigned compute_units = 0;
  std::size_t memory_bytes = 0;
};

// Options for programs that have a shorter way for PoCL on an x86 CPU with AVX (shared/pocl.h); elsewhere none.
std::string avx_options(const DeviceInfo& device);

// What the host asked of a device so far, and what it waited for.
struct DeviceCounts {
  std::size_t launches = 0;  // kernels, fills and copies on the device
  std::size_t writes = 0;    // small ones, that wait for nothing
  std::size_t waits = 0;     // calls that return when the device has done what came before: reads, large writes, finish
  std::size_t bytes = 0;     // read and written by the host
  DeviceCounts& operator+=(const DeviceCounts& other);
  DeviceCounts operator-(const DeviceCounts& other) const;
};

// The same by what was asked for, as in "kernel cg_test", "wait for a read of x": how often.
using DeviceCountsByName = std::map<std::string, std::size_t>;

// All devices that the OpenCL loader knows; empty where there is none.
std::vector<DeviceInfo> list_devices();

// What a device is wanted for: the contact solver computes in double precision, rendering takes none.
enum class Purpose { physics, rendering };

namespace detail {
class Memory;
struct HostAccess {
  Memory* memory;
  std::size_t bytes;
  bool is_read, is_written;
};
}  // namespace detail

class Device {
 public:
  // `which`: an index, a part of a name or platform, "cpu" or "gpu"; empty: the first GPU with double precision, for
  // rendering any GPU, else the first device. Throws a UsageError where nothing fits, or where the chosen one lacks
  // the double precision that physics needs.
  explicit Device(const std::string& which = "", Purpose purpose = Purpose::physics);
  ~Device();
  Device(Device&&) noexcept;
  Device(const Device&) = delete;
  const DeviceInfo& info() const;
  // The compute units of a CPU, each a device with memory, programs and a queue of its own, which run side by side.
  // Empty where the driver does not divide this device, as those of GPUs do not.
  std::vector<Device> compute_units() const;
  void finish();  // waits for everything that was started
  // Calls `task` after what was started before, with the numbers of each buffer: made by reads() and writes() below.
  // Where the device runs host functions this is one command of its queue, which moves nothing and waits for nothing;
  // elsewhere the numbers are read, the host waits, and what was written goes back. The task must not throw and must
  // not use the device.
  using HostTask = std::function<void(std::span<void* const>)>;
  void call(std::vector<detail::HostAccess> access, HostTask task);
  std::size_t peak_bytes() const;             // largest sum of live buffers so far
  DeviceCounts counts() const;                // so far
  void count_by_name();                       // from now on, which takes time
  DeviceCountsByName counts_by_name() const;  // since then; empty without it
  // Compiled programs are kept in this folder from now on. Without this call: in the user's cache, where the platform
  // keeps none itself.
  void keep_programs_in(const std::string& folder);
  std::size_t n_compiled() const;  // programs so far that were not found compiled

  struct Impl;
  Impl& impl() { return *impl_; }

 private:
  explicit Device(std::unique_ptr<Impl> impl);  // whose `info` and `id` are known
  std::unique_ptr<Impl> impl_;
};

namespace detail {
// Untyped device memory, one owner.
class Memory {
 public:
  Memory(Device& device, std::size_t bytes, std::string name);
  ~Memory();
  Memory(Memory&& other) noexcept;
  Memory& operator=(Memory&& other) noexcept;
  void write(const void* from, std::size_t offset, std::size_t bytes);
  void read(void* to, std::size_t offset, std::size_t bytes) const;
  void read_later(void* to, std::size_t offset, std::size_t bytes) const;
  void fill_zero(std::size_t bytes);
  void copy_from(const Memory& other, std::size_t bytes);
  const void* handle() const { return &handle_; }
  std::size_t serial() const { return serial_; }  // of the handle: a driver may use a freed one's address again
  const std::string& name() const { return name_; }
  Device& device() const { return *device_; }

 private:
  Device* device_ = nullptr;
  void* handle_ = nullptr;
  std::size_t bytes_ = 0, serial_ = 0;
  std::string name_;
};
void throw_size_mismatch(const std::string& name, std::size_t has, std::size_t given);
}  // namespace detail

// n elements of T on the device, named for messages.
template <class T>
class Buffer {
  static_assert(std::is_trivially_copyable_v<T>);

 public:
  Buffer(Device& device, std::size_t n, std::string name)
      // OpenCL knows no empty buffer; ours holds one element that nobody reads
      : memory_(device, (n ? n : 1) * sizeof(T), std::move(name)), n_(n), capacity_(n ? n : 1) {}
  Buffer(Device& device, std::span<const T> values, std::string name) : Buffer(device, values.size(), std::move(name)) {
    write(values);
  }
  Buffer(Device& device, const std::vector<T>& values, std::string name)
      : Buffer(device, std::span<const T>(values), std::move(name)) {}

  void write(std::span<const T> values) {
    if (values.size() != n_) detail::throw_size_mismatch(memory_.name(), n_, values.size());
    if (n_) memory_.write(values.data(), 0, n_ * sizeof(T));
  }
  void write(std::size_t first, std::span<const T> values) {
    if (first + values.size() > n_) detail::throw_size_mismatch(memory_.name(), n_, first + values.size());
    if (!values.empty()) memory_.write(values.data(), first * sizeof(T), values.size() * sizeof(T));
  }
  std::vector<T> read() const { return read(0, n_); }
  std::vector<T> read(std::size_t first, std::size_t count) const {
    std::vector<T> values(count);
    read(first, std::span<T>(values));
    return values;
  }
  void read(std::size_t first, std::span<T> values) const {
    if (first + values.size() > n_) detail::throw_size_mismatch(memory_.name(), n_, first + values.size());
    if (!values.empty()) memory_.read(values.data(), first * sizeof(T), values.size() * sizeof(T));
  }
  // Starts to read; the numbers are there after Device::finish().
  void read_later(std::size_t first, std::span<T> values) const {
    if (first + values.size() > n_) detail::throw_size_mismatch(memory_.name(), n_, first + values.size());
    if (!values.empty()) memory_.read_later(values.data(), first * sizeof(T), values.size() * sizeof(T));
  }
  void zero() {
    if (n_) memory_.fill_zero(n_ * sizeof(T));
  }
  void copy_from(const Buffer& other) {
    if (other.n_ != n_) detail::throw_size_mismatch(memory_.name(), n_, other.n_);
    if (n_) memory_.copy_from(other.memory_, n_ * sizeof(T));
  }
  // makes room for n elements; what was in it is lost where it has to grow. Never shrinks the memory.
  void resize(std::size_t n) {
    if (n > capacity_) {
      const std::size_t grown = n + n / 2;
      memory_ = detail::Memory(memory_.device(), grown * sizeof(T), memory_.name());
      capacity_ = grown;
    }
    n_ = n;
  }
  std::size_t size() const { return n_; }
  const std::string& name() const { return memory_.name(); }
  const detail::Memory& memory() const { return memory_; }
  detail::Memory& memory() { return memory_; }

 private:
  detail::Memory memory_;
  std::size_t n_, capacity_;
};

// What a host function does with a buffer.
template <class T>
detail::HostAccess reads(const Buffer<T>& buffer) {
  return {const_cast<detail::Memory*>(&buffer.memory()), buffer.size() * sizeof(T), true, false};
}
template <class T>
detail::HostAccess writes(Buffer<T>& buffer) {  // all of it
  return {&buffer.memory(), buffer.size() * sizeof(T), false, true};
}

// kernel(n, arguments...) starts n work-items (padded to whole groups), none for n = 0. Arguments are buffers, numbers
// and shared structs, as many as the kernel declares; anything else throws before it runs. So do two buffers that bear
// each the name of the other's argument: they were swapped. An argument that is what it was at the last call is not
// given to the driver again, which takes as long as a small launch.
class Kernel {
 public:
  Kernel(Device& device, void* program, const std::string& name);
  ~Kernel();
  Kernel(Kernel&& other) noexcept;
  Kernel(const Kernel&) = delete;

  template <class... A>
  void operator()(std::size_t n, const A&... arguments) {
    begin(sizeof...(A));
    if (n == 0) return;
    unsigned i = 0;
    (set(i++, arguments), ...);
    launch(n);
  }
  const std::string& name() const { return name_; }

 private:
  template <class T>
  void set(unsigned i, const Buffer<T>& buffer) {
    set_memory(i, buffer.memory());
  }
  template <class T>
  requires std::is_trivially_copyable_v<T>
  void set(unsigned i, const T& value) { set_bytes(i, &value, sizeof(T)); }
  void begin(std::size_t n_arguments);
  void set_memory(unsigned i, const detail::Memory& memory);
  void set_bytes(unsigned i, const void* value, std::size_t bytes);
  void check_names() const;
  void launch(std::size_t n);
  bool is_known(unsigned i, const void* value, std::size_t bytes);  // and remembered from now on

  Device* device_;
  void* handle_ = nullptr;
  std::string name_;
  unsigned n_arguments_ = 0;
  std::size_t group_size_ = GROUP_SIZE;
  std::vector<std::string> argument_names_;        // [n_arguments]; empty where the driver does not tell
  std::vector<std::string> buffer_names_;          // [n_arguments] as last set; of numbers empty
  bool has_new_names_ = false;                     // not checked yet
  std::vector<std::vector<unsigned char>> given_;  // [n_arguments] as last set
};

// The kernels of one file; `file` is relative to kernels/, as in "energies/joint/zero_length_spring.cl". Its #include
// lines are resolved here, so that the driver sees one text. `defines` as in "-DREAL_IS_DOUBLE".
class Program {
 public:
  Program(Device& device, const std::string& file, const std::string& defines = "");
  // Kernels from a text made at run time; `name` is for messages, #include lines are resolved as above.
  static Program from_text(Device& device, const std::string& name, const std::string& text,
                           const std::string& defines = "");
  ~Program();
  Program(Program&& other) noexcept;
  Program(const Program&) = delete;
  Kernel kernel(const std::string& name);

 private:
  Program() = default;
  void build(const std::string& name, const std::string& text, const std::string& defines);
  Device* device_ = nullptr;
  void* handle_ = nullptr;
};

// Folder of the kernels: $PVG_KERNELS, else beside the installed program, else the source tree.
std::string kernel_folder();

}  // namespace pvg
