// Kernel text to program: #include lines are resolved here, each file once, with #line marks for the driver's messages.
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <utility>

#include "host/base/files.hpp"
#include "host/device/impl.hpp"

namespace pvg {
namespace {

std::string read_kernel_file(const std::string& file) {
  const std::optional<std::string> text = read_whole_file(kernel_folder() + "/" + file);
  if (!text)
    throw DeviceError("kernel file " + file + " is missing in " + kernel_folder() + "; set PVG_KERNELS or reinstall");
  return *text;
}

void expand(const std::string& name, const std::string& text, std::ostream& out, int depth = 0) {
  if (depth > 16) throw DeviceError("kernel file " + name + " includes itself without end");
  std::istringstream in(text);
  std::string line;
  out << "#line 1 \"" << name << "\"\n";
  for (int number = 1; std::getline(in, line); ++number) {
    const std::string mark = "#include \"";
    if (line.compare(0, mark.size(), mark) != 0) {
      out << line << "\n";
      continue;
    }
    const std::string file = line.substr(mark.size(), line.find('"', mark.size()) - mark.size());
    expand(file, read_kernel_file(file), out, depth + 1);
    out << "#line " << number + 1 << " \"" << name << "\"\n";
  }
}

}  // namespace

std::string kernel_folder() {
  if (const char* folder = std::getenv("PVG_KERNELS")) return folder;
  std::error_code ignored;
  const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe", ignored);
  const std::filesystem::path installed = program.parent_path().parent_path() / "share/phyvisgen/kernels";
  if (std::filesystem::exists(installed, ignored)) return installed.string();
  return PVG_KERNEL_SOURCE_FOLDER;
}

Program::Program(Device& device, const std::string& file, const std::string& defines) : device_(&device) {
  build(file, read_kernel_file(file), defines);
}

Program Program::from_text(Device& device, const std::string& name, const std::string& text,
                           const std::string& defines) {
  Program program;
  program.device_ = &device;
  program.build(name, text, defines);
  return program;
}

void Program::build(const std::string& name, const std::string& text, const std::string& defines) {
  std::ostringstream expanded;
  expand(name, text, expanded);
  const std::string source = expanded.str();
  const std::string options = "-cl-std=CL1.2 " + defines;
  Device::Impl& impl = device_->impl();
  const std::lock_guard lock(impl.building);
  if (const auto known = impl.built.find(options + "\n" + source); known != impl.built.end()) {
    handle_ = known->second;
    clRetainProgram(known->second);
    return;
  }
  const char* pointer = source.c_str();
  cl_int code = 0;
  handle_ = clCreateProgramWithSource(impl.context, 1, &pointer, nullptr, &code);
  if (code != CL_SUCCESS) throw DeviceError("kernel file " + name + " could not be given to the driver");
  const cl_device_id id = impl.id;
  code = clBuildProgram(static_cast<cl_program>(handle_), 1, &id, options.c_str(), nullptr, nullptr);
  if (code == CL_SUCCESS) {
    impl.built.emplace(options + "\n" + source, static_cast<cl_program>(handle_));
    clRetainProgram(static_cast<cl_program>(handle_));
    return;
  }
  std::size_t bytes = 0;
  clGetProgramBuildInfo(static_cast<cl_program>(handle_), id, CL_PROGRAM_BUILD_LOG, 0, nullptr, &bytes);
  std::string log(bytes, '\0');
  clGetProgramBuildInfo(static_cast<cl_program>(handle_), id, CL_PROGRAM_BUILD_LOG, bytes, log.data(), nullptr);
  throw DeviceError("kernel file " + name + " does not build on " + device_->info().name + ":\n" + log);
}

Program::~Program() {
  if (handle_) clReleaseProgram(static_cast<cl_program>(handle_));
}
Program::Program(Program&& other) noexcept : device_(other.device_), handle_(std::exchange(other.handle_, nullptr)) {}

Kernel Program::kernel(const std::string& name) { return Kernel(*device_, handle_, name); }

}  // namespace pvg
