// Kernel text to program: #include lines are resolved here, each file once, with #line marks for the driver's messages.
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <regex>
#include <sstream>
#include <utility>
#include <vector>

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

// NVIDIA's driver tells places by the line of the whole text, as in "<kernel>:12:3: error", whatever #line says.
// Returns the log with file and line in their stead.
std::string with_places(const std::string& log, const std::string& source) {
  std::vector<std::string> places = {""};  // of each line of the text, from 1 on
  std::istringstream text(source);
  std::string line, file;
  for (int next = 1; std::getline(text, line);) {
    places.push_back(file + ":" + std::to_string(next++));
    if (line.rfind("#line ", 0) != 0) continue;
    next = std::stoi(line.substr(6));
    const std::size_t quote = line.find('"');
    file = line.substr(quote + 1, line.rfind('"') - quote - 1);
  }
  static const std::regex place("<kernel>:([0-9]{1,7})");
  std::string told;
  auto rest = log.begin();
  for (std::sregex_iterator match(log.begin(), log.end(), place), end; match != end; ++match) {
    const std::size_t number = std::stoul((*match)[1]);
    told.append(rest, (*match)[0].first);
    told += number < places.size() ? places[number] : (*match)[0].str();
    rest = (*match)[0].second;
  }
  return told.append(rest, log.end());
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

namespace {

// The program that was kept, ready to run; null where the driver does not take it.
cl_program load(Device::Impl& impl, const std::vector<unsigned char>& kept, const std::string& options) {
  const unsigned char* bytes = kept.data();
  const std::size_t size = kept.size();
  cl_int code = 0;
  const cl_program program = clCreateProgramWithBinary(impl.context, 1, &impl.id, &size, &bytes, nullptr, &code);
  if (code != CL_SUCCESS) return nullptr;
  if (clBuildProgram(program, 1, &impl.id, options.c_str(), nullptr, nullptr) == CL_SUCCESS) return program;
  clReleaseProgram(program);
  return nullptr;
}

// empty where the driver does not tell
std::vector<unsigned char> compiled_bytes(cl_program program) {
  std::size_t size = 0;
  if (clGetProgramInfo(program, CL_PROGRAM_BINARY_SIZES, sizeof size, &size, nullptr) != CL_SUCCESS) return {};
  std::vector<unsigned char> bytes(size);
  unsigned char* to = bytes.data();
  if (clGetProgramInfo(program, CL_PROGRAM_BINARIES, sizeof to, &to, nullptr) != CL_SUCCESS) return {};
  return bytes;
}

cl_program compile(Device::Impl& impl, const std::string& name, const std::string& source, const std::string& options) {
  const char* pointer = source.c_str();
  cl_int code = 0;
  const cl_program program = clCreateProgramWithSource(impl.context, 1, &pointer, nullptr, &code);
  if (code != CL_SUCCESS) throw DeviceError("kernel file " + name + " could not be given to the driver");
  ++impl.n_compiled;
  code = clBuildProgram(program, 1, &impl.id, options.c_str(), nullptr, nullptr);
  if (code == CL_SUCCESS) return program;
  std::size_t bytes = 0;
  clGetProgramBuildInfo(program, impl.id, CL_PROGRAM_BUILD_LOG, 0, nullptr, &bytes);
  std::string log(bytes, '\0');
  clGetProgramBuildInfo(program, impl.id, CL_PROGRAM_BUILD_LOG, bytes, log.data(), nullptr);
  clReleaseProgram(program);
  throw DeviceError("kernel file " + name + " does not build on " + impl.info.name + ":\n" + with_places(log, source));
}

}  // namespace

void Program::build(const std::string& name, const std::string& text, const std::string& defines) {
  std::ostringstream expanded;
  expand(name, text, expanded);
  const std::string source = expanded.str();
  const std::string options = "-cl-std=CL1.2 -cl-kernel-arg-info " + defines;
  Device::Impl& impl = device_->impl();
  const std::lock_guard lock(impl.building);
  const auto known = impl.built.try_emplace(options + "\n" + source, nullptr).first;
  if (!known->second) {
    const DeviceInfo& info = impl.info;
    const std::string key =
        info.platform + "\n" + info.name + "\n" + info.driver + "\n" + info.version + "\n" + known->first;
    if (const auto kept = impl.cache.find(key)) known->second = load(impl, *kept, options);
    if (!known->second) {
      known->second = compile(impl, name, source, options);
      // asked for its bytes, PoCL compiles every kernel once more, for work-groups of any size
      if (impl.cache.keeps_programs()) impl.cache.keep(key, compiled_bytes(known->second));
    }
  }
  handle_ = known->second;
  clRetainProgram(known->second);
}

Program::~Program() {
  if (handle_) clReleaseProgram(static_cast<cl_program>(handle_));
}
Program::Program(Program&& other) noexcept : device_(other.device_), handle_(std::exchange(other.handle_, nullptr)) {}

Kernel Program::kernel(const std::string& name) { return Kernel(*device_, handle_, name); }

}  // namespace pvg
