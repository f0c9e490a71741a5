#include "host/base/quiet_libraries.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cstdio>
#include <mutex>

namespace pvg {
namespace {
std::mutex one_at_a_time;
}

QuietLibraries::QuietLibraries() {
  one_at_a_time.lock();
  std::fflush(stderr);
  kept_ = fcntl(STDERR_FILENO, F_DUPFD_CLOEXEC, 3);
  const int nowhere = open("/dev/null", O_WRONLY | O_CLOEXEC);
  if (kept_ >= 0 && nowhere >= 0) dup2(nowhere, STDERR_FILENO);
  if (nowhere >= 0) close(nowhere);
}

QuietLibraries::~QuietLibraries() {
  std::fflush(stderr);
  if (kept_ >= 0) {
    dup2(kept_, STDERR_FILENO);
    close(kept_);
  }
  one_at_a_time.unlock();
}

}  // namespace pvg
