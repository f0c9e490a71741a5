#include "pipeline/serve/shared_memory.hpp"

#include <fcntl.h>
#include <linux/magic.h>
#include <sys/stat.h>
#include <sys/vfs.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>

namespace pvg {
namespace {

void check(int file, const std::string& path, std::size_t least) {
  struct statfs system {};
  struct stat about {};
  if (fstatfs(file, &system) != 0 || fstat(file, &about) != 0)
    throw UsageError("`memory` names " + path + ": " + std::strerror(errno));
  if (system.f_type != TMPFS_MAGIC || !S_ISREG(about.st_mode))
    throw UsageError("`memory` names " + path + ", which is no file in memory; make it in /dev/shm or by memfd_create");
  if (std::size_t(about.st_size) < least)
    throw MemoryTooSmall("`memory` has " + std::to_string(about.st_size) + " bytes, the arrays take " +
                             std::to_string(least) + "; make it longer",
                         least);
}

}  // namespace

SharedMemory::SharedMemory(const std::string& path, std::size_t least)
    : file_(open(path.c_str(), O_WRONLY | O_CLOEXEC | O_NONBLOCK)) {
  if (file_ < 0) throw UsageError("`memory` names " + path + ", which cannot be opened: " + std::strerror(errno));
  try {
    check(file_, path, least);
  } catch (...) {
    close(file_);
    throw;
  }
}

SharedMemory::SharedMemory(SharedMemory&& other) noexcept : file_(std::exchange(other.file_, -1)) {}

SharedMemory::~SharedMemory() {
  if (file_ >= 0) close(file_);
}

// not mapped: a client that makes its file shorter meanwhile would end the server
void SharedMemory::write(std::size_t offset, std::span<const std::uint8_t> bytes) const {
  for (std::size_t done = 0; done < bytes.size();) {
    const ssize_t n = pwrite(file_, bytes.data() + done, bytes.size() - done, off_t(offset + done));
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) throw Failure(std::string("`memory` cannot be written: ") + std::strerror(errno));
    done += std::size_t(n);
  }
}

}  // namespace pvg
