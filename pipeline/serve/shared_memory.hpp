// Memory that a client of `serve` shares: a file of a memory file system, mapped by both.
#pragma once
#include <cstddef>
#include <span>
#include <string>

namespace pvg {

class SharedMemory {
 public:
  // Maps the whole file. A UsageError where it cannot be opened, lies on a disk or has fewer than `least` bytes.
  SharedMemory(const std::string& path, std::size_t least);
  ~SharedMemory();
  SharedMemory(SharedMemory&& other) noexcept;
  SharedMemory(const SharedMemory&) = delete;
  std::span<unsigned char> bytes() const { return bytes_; }

 private:
  std::span<unsigned char> bytes_;
};

}  // namespace pvg
