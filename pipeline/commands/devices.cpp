// phyvisgen devices: what OpenCL finds on this machine.
#include <cstdio>
#include <nlohmann/json.hpp>

#include "host/base/counted.hpp"
#include "host/device/device.hpp"
#include "pipeline/command_line/command.hpp"

namespace pvg {
namespace {

struct DevicesOptions {
  bool as_json = false;
};

void print_table(const std::vector<DeviceInfo>& devices) {
  for (const DeviceInfo& device : devices)
    std::printf("%zu  %s\n   %s, %s, %s, %.1f GiB, %s, driver %s\n", device.index, device.name.c_str(),
                device.platform.c_str(), device.is_gpu ? "GPU" : "CPU",
                counted(device.compute_units, "compute unit").c_str(), double(device.memory_bytes) / double(1u << 30),
                device.has_fp64 ? "double precision" : "no double precision: renders only", device.driver.c_str());
}

void print_json(const std::vector<DeviceInfo>& devices) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const DeviceInfo& device : devices)
    list.push_back({{"index", device.index},
                    {"name", device.name},
                    {"platform", device.platform},
                    {"driver", device.driver},
                    {"version", device.version},
                    {"kind", device.is_gpu ? "gpu" : "cpu"},
                    {"double_precision", device.has_fp64},
                    {"compute_units", device.compute_units},
                    {"memory_bytes", device.memory_bytes}});
  std::printf("%s\n", nlohmann::ordered_json{{"schema", 1}, {"devices", list}}.dump(2).c_str());
}

void run_devices(const DevicesOptions& options) {
  const std::vector<DeviceInfo> devices = list_devices();
  if (devices.empty())
    throw Failure("no OpenCL device was found: install a driver (Debian package pocl-opencl-icd for the CPU)");
  options.as_json ? print_json(devices) : print_table(devices);
}

}  // namespace

void add_devices(CLI::App& program) {
  CLI::App* command = program.add_subcommand("devices", "List the OpenCL devices that --device can name");
  DevicesOptions& o = options_of_command(*command, run_devices);
  command->add_flag("--json", o.as_json, "Print JSON");
  command->footer("Example:\n  phyvisgen devices --json");
}

}  // namespace pvg
