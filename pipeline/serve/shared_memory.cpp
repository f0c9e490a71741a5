#include "pipeline/serve/shared_memory.hpp"

#include <fcntl.h>
#include <linux/magic.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/vfs.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>

#include "host/base/error.hpp"

namespace pvg {
namespace {

struct OpenFile {
  int number;
  ~OpenFile() {
    if (number >= 0) close(number);
  }
};

}  // namespace

SharedMemory::SharedMemory(const std::string& path, std::size_t least) {
  const OpenFile file{open(path.c_str(), O_RDWR | O_CLOEXEC)};
  if (file.number < 0) throw UsageError("`memory` names " + path + ", which cannot be opened: " + std::strerror(errno));
  struct statfs system {};
  struct stat about {};
  if (fstatfs(file.number, &system) != 0 || fstat(file.number, &about) != 0)
    throw UsageError("`memory` names " + path + ": " + std::strerror(errno));
  if (system.f_type != TMPFS_MAGIC || !S_ISREG(about.st_mode))
    throw UsageError("`memory` names " + path + ", which is no file in memory; make it in /dev/shm or by memfd_create");
  const std::size_t size = std::size_t(about.st_size);
  if (size < least)
    throw UsageError("`memory` has " + std::to_string(size) + " bytes, the pictures take " + std::to_string(least));
  void* mapped = mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_SHARED, file.number, 0);
  if (mapped == MAP_FAILED)
    throw UsageError("`memory` names " + path + ", which cannot be mapped: " + std::strerror(errno));
  bytes_ = {static_cast<unsigned char*>(mapped), size};
}

SharedMemory::SharedMemory(SharedMemory&& other) noexcept : bytes_(std::exchange(other.bytes_, {})) {}

SharedMemory::~SharedMemory() {
  if (!bytes_.empty()) munmap(bytes_.data(), bytes_.size());
}

}  // namespace pvg
