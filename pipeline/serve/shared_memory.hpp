// Memory that a client of `serve` shares: a file of a memory file system, which the client maps.
#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "host/base/error.hpp"

namespace pvg {

// The memory is shorter than what is to be written into it.
struct MemoryTooSmall : UsageError {
  MemoryTooSmall(const std::string& what, std::size_t needed) : UsageError(what), needed(needed) {}
  std::size_t needed;  // [bytes]
};

class SharedMemory {
 public:
  // Opens the file. A UsageError where it cannot be opened or lies on a disk, a MemoryTooSmall where it has fewer than
  // `least` bytes.
  SharedMemory(const std::string& path, std::size_t least);
  ~SharedMemory();
  SharedMemory(SharedMemory&& other) noexcept;
  SharedMemory(const SharedMemory&) = delete;
  // A Failure where the memory is full.
  void write(std::size_t offset, std::span<const std::uint8_t> bytes) const;

 private:
  int file_ = -1;
};

}  // namespace pvg
