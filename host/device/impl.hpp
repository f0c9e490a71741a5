// What a Device holds; seen by host/device only.
#pragma once
#define CL_TARGET_OPENCL_VERSION 120
#define CL_USE_DEPRECATED_OPENCL_1_2_APIS
#include <CL/cl.h>
#include <atomic>
#include <deque>
#include <map>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "host/device/device.hpp"
#include "host/device/program_cache.hpp"

namespace pvg {

struct Device::Impl {
  DeviceInfo info;
  cl_device_id id = nullptr;
  bool is_part = false;  // of another device: its id is ours to give back
  cl_context context = nullptr;
  cl_command_queue queue = nullptr;
  std::atomic<std::size_t> live_bytes = 0, peak_bytes = 0;                          // episodes share a device
  std::atomic<std::size_t> n_launches = 0, n_writes = 0, n_waits = 0, n_bytes = 0;  // as in DeviceCounts
  std::atomic<std::size_t> n_buffers = 0;                                           // made so far
  std::atomic<bool> counts_names = false;
  std::mutex counting;
  DeviceCountsByName by_name;  // of launches, writes and waits
  void count(const char* what, const std::string& name) {
    if (!counts_names) return;
    const std::lock_guard lock(counting);
    ++by_name[what + name];
  }
  // Commands of the queue whose times the driver was asked for (command_times.hpp), under the names of their kinds.
  bool times_commands = false;
  std::mutex timing;
  std::deque<std::pair<std::string, cl_event>> timed;
  // where the command that is about to start leaves its event; null where nobody asked for times
  cl_event* timed_event(const char* what, const std::string& name) {
    if (!times_commands) return nullptr;
    const std::lock_guard lock(timing);
    return &timed.emplace_back(what + name, nullptr).second;
  }

  // Small writes do not wait for what was started before them: their bytes are kept here until something that came
  // later in the queue has ended.
  struct Staged {
    std::size_t number;
    std::vector<unsigned char> bytes;
  };
  std::mutex staging;  // of what follows, and of the order in the queue
  std::deque<Staged> staged;
  std::size_t n_staged = 0;

  std::size_t staged_so_far() {
    const std::lock_guard lock(staging);
    return n_staged;
  }
  void forget_staged(std::size_t before) {
    const std::lock_guard lock(staging);
    while (!staged.empty() && staged.front().number < before) staged.pop_front();
  }
  // Programs that were built on this device, by options and text: who asks for the same again shares it.
  std::mutex building;
  std::map<std::string, cl_program> built;
  ProgramCache cache{{}};  // on disk; keeps nothing where the platform does so itself
  std::size_t n_compiled = 0;

  ~Impl() {
    for (const auto& [name, event] : timed)
      if (event) clReleaseEvent(event);
    if (queue) clFinish(queue), clReleaseCommandQueue(queue);
    for (const auto& [text, program] : built)
      if (program) clReleaseProgram(program);
    if (context) clReleaseContext(context);
    if (is_part) clReleaseDevice(id);
  }
};

}  // namespace pvg
