// Work that may crash, never end or take all memory, such as a library's on a damaged file: done in a process of its
// own.
#pragma once
#include <cstdint>
#include <cstring>
#include <functional>
#include <string>
#include <vector>

namespace pvg {

struct ProcessLimits {
  std::uintmax_t bytes = 0;    // of memory, beside what this process has
  std::uintmax_t seconds = 0;  // of computing
};

// What `work` returns. Its UsageErrors are thrown here, and so is one that begins with `what` where it crashes or
// exceeds the limits. `work` must not touch the device.
std::string in_child_process(const std::string& what, const ProcessLimits& limits,
                             const std::function<std::string()>& work);

// ---- vectors as bytes: the number of entries, then these

template <typename T>
void pack(std::string& bytes, const std::vector<T>& values) {
  const std::uint64_t n = values.size();
  bytes.append(reinterpret_cast<const char*>(&n), sizeof n);
  bytes.append(reinterpret_cast<const char*>(values.data()), n * sizeof(T));
}

template <typename T>
void unpack(const std::string& bytes, std::size_t& at, std::vector<T>& values) {
  std::uint64_t n = 0;
  std::memcpy(&n, bytes.data() + at, sizeof n);
  at += sizeof n;
  values.resize(n);
  if (n > 0) std::memcpy(static_cast<void*>(values.data()), bytes.data() + at, n * sizeof(T));
  at += n * sizeof(T);
}

}  // namespace pvg
