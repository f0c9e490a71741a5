// A kernel and what it was given: arguments that have not changed are not set again.
#include <cstring>
#include <utility>

#include "host/device/opencl_error.hpp"

namespace pvg {
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

// as its source requires; else that of all launches
std::size_t group_size_of(const Device::Impl& impl, cl_kernel kernel) {
  std::size_t required[3] = {};
  const cl_int code =
      clGetKernelWorkGroupInfo(kernel, impl.id, CL_KERNEL_COMPILE_WORK_GROUP_SIZE, sizeof required, required, nullptr);
  return code == CL_SUCCESS && required[0] > 0 ? required[0] : GROUP_SIZE;
}

}  // namespace

Kernel::Kernel(Device& device, void* program, const std::string& name) : device_(&device), name_(name) {
  cl_int code = 0;
  handle_ = clCreateKernel(static_cast<cl_program>(program), name.c_str(), &code);
  require(code, "make kernel " + name);
  require(
      clGetKernelInfo(static_cast<cl_kernel>(handle_), CL_KERNEL_NUM_ARGS, sizeof n_arguments_, &n_arguments_, nullptr),
      "ask kernel " + name + " for its arguments");
  group_size_ = group_size_of(device.impl(), static_cast<cl_kernel>(handle_));
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
      group_size_(other.group_size_),
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
  device_->impl().count("kernel ", name_);
  const std::size_t local = group_size_, global = (n + local - 1) / local * local;
  const cl_int code =
      clEnqueueNDRangeKernel(device_->impl().queue, static_cast<cl_kernel>(handle_), 1, nullptr, &global, &local, 0,
                             nullptr, device_->impl().timed_event("kernel ", name_));
  if (code != CL_SUCCESS) require(code, "run kernel " + name_);
}

}  // namespace pvg
