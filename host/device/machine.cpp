#include "host/device/machine.hpp"

#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <mutex>
#include <string>

#include "host/base/notes.hpp"

namespace pvg {
namespace {

namespace fs = std::filesystem;

bool can_hold_files(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  return !error && access(folder.c_str(), W_OK | X_OK) == 0;
}

// where PoCL puts what it compiles if nothing is said
fs::path usual_cache() {
  if (const char* cache = std::getenv("XDG_CACHE_HOME"); cache && *cache) return fs::path(cache) / "pocl";
  if (const char* home = std::getenv("HOME"); home && *home) return fs::path(home) / ".cache/pocl";
  return {};
}

}  // namespace

std::uint64_t memory_of_machine() {
  std::uint64_t bytes = std::uint64_t(sysconf(_SC_PHYS_PAGES)) * std::uint64_t(sysconf(_SC_PAGESIZE));
  for (const char* limit : {"/sys/fs/cgroup/memory.max", "/sys/fs/cgroup/memory/memory.limit_in_bytes"}) {
    std::uint64_t most = 0;
    if (std::ifstream(limit) >> most && most > 0) bytes = std::min(bytes, most);  // "max": no limit
  }
  return bytes;
}

void find_cache_folder() {
  static std::once_flag once;
  std::call_once(once, [] {
    const char* chosen = std::getenv("POCL_CACHE_DIR");
    if (chosen ? can_hold_files(chosen) : can_hold_files(usual_cache())) return;
    std::error_code ignored;
    const fs::path temporary = fs::temp_directory_path(ignored);
    const fs::path folder =
        (ignored ? fs::path("/tmp") : temporary) / ("phyvisgen-kernels-" + std::to_string(getuid()));
    if (!can_hold_files(folder)) return;
    setenv("POCL_CACHE_DIR", folder.c_str(), 1);
    tell_note((chosen ? std::string("POCL_CACHE_DIR ") + chosen : std::string("HOME")) +
              " cannot be written to: compiled kernels go to " + folder.string() +
              "; name another folder in POCL_CACHE_DIR");
  });
}

}  // namespace pvg
