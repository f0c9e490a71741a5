#include "host/base/atomic_files.hpp"

#include <fcntl.h>
#include <signal.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <cstring>
#include <mutex>
#include <set>

#include "host/base/error.hpp"

namespace pvg {
namespace {

namespace fs = std::filesystem;

constexpr const char* PARTIAL = ".partial-";

std::string host_name() {
  char name[256] = "";
  gethostname(name, sizeof name - 1);
  return name;
}

// .NAME.partial-PID.HOST: numbers of processes count on their machine alone, and machines may share a folder
fs::path partial_path(const fs::path& target) {
  return target.parent_path() /
         ("." + target.filename().string() + PARTIAL + std::to_string(getpid()) + "." + host_name());
}

// the folders that this process has in the making
std::mutex unfinished_mutex;
std::set<fs::path> unfinished;

[[noreturn]] void fail(const fs::path& path, const char* what) {
  throw Failure(path.string() + " could not be " + what + ": " + std::strerror(errno));
}

// brings a file's or a folder's contents to the disk
void sync(const fs::path& path) {
  const int file = open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (file < 0) fail(path, "opened");
  const int code = fsync(file);
  // some file systems know no sync of a folder; that is no loss of ours
  const bool is_bad = code != 0 && errno != EINVAL;
  close(file);
  if (is_bad) fail(path, "brought to the disk");
}

void write_whole(const fs::path& path, const std::string& text) {
  const int file = open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (file < 0) fail(path, "created");
  for (std::size_t done = 0; done < text.size();) {
    const ssize_t n = write(file, text.data() + done, text.size() - done);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) {
      close(file);
      fail(path, "written");
    }
    done += std::size_t(n);
  }
  const int code = fsync(file);
  close(file);
  if (code != 0) fail(path, "brought to the disk");
}

}  // namespace

void write_text_atomically(const fs::path& path, const std::string& text) {
  const fs::path partial = partial_path(path);
  write_whole(partial, text);
  if (std::rename(partial.c_str(), path.c_str()) != 0) fail(path, "replaced");
}

PartialFolder::PartialFolder(const fs::path& target) : target_(target), path_(partial_path(target)) {
  std::error_code error;
  fs::remove_all(path_, error);
  if (!fs::create_directory(path_, error)) throw UsageError(path_.string() + " could not be made: " + error.message());
  const std::lock_guard lock(unfinished_mutex);
  unfinished.insert(path_);
}

PartialFolder::~PartialFolder() {
  if (path_.empty()) return;
  std::error_code ignored;
  fs::remove_all(path_, ignored);
  const std::lock_guard lock(unfinished_mutex);
  unfinished.erase(path_);
}

void PartialFolder::finish() {
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(path_)) sync(entry.path());
  sync(path_);
  std::error_code ignored;
  fs::remove_all(target_, ignored);
  if (std::rename(path_.c_str(), target_.c_str()) != 0) fail(target_, "made");
  {
    const std::lock_guard lock(unfinished_mutex);
    unfinished.erase(path_);
  }
  path_.clear();
  sync(target_.parent_path());
}

void remove_unfinished_folders() {
  const std::lock_guard lock(unfinished_mutex);
  std::error_code ignored;
  for (const fs::path& path : unfinished)
    // other threads may still be writing there: what they put after the first pass goes in the next
    for (int tries = 0; tries < 10 && fs::exists(path, ignored); ++tries) fs::remove_all(path, ignored);
}

std::size_t remove_leftovers(const fs::path& parent) {
  std::size_t n = 0;
  std::error_code ignored;
  for (const fs::directory_entry& entry : fs::directory_iterator(parent, ignored)) {
    const std::string name = entry.path().filename().string();
    const std::size_t mark = name.rfind(PARTIAL);
    if (name.empty() || name[0] != '.' || mark == std::string::npos) continue;
    pid_t owner = 0;
    const char* number = name.data() + mark + std::strlen(PARTIAL);
    const auto parsed = std::from_chars(number, name.data() + name.size(), owner);
    if (parsed.ec != std::errc() || parsed.ptr == name.data() + name.size() || owner <= 0) continue;
    if (std::string(parsed.ptr) != "." + host_name()) continue;  // no way to ask whether it is alive
    // another process may be writing it right now: shards share a folder
    const bool is_alive = kill(owner, 0) == 0 || errno == EPERM;
    if (is_alive && owner != getpid()) continue;
    n += fs::remove_all(entry.path(), ignored) > 0;
  }
  return n;
}

void make_writable_folder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) throw UsageError("the output folder " + folder.string() + " could not be made: " + error.message());
  const fs::path probe = folder / (".probe" + std::string(PARTIAL) + std::to_string(getpid()) + "." + host_name());
  const int file = open(probe.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0666);
  if (file < 0)
    throw UsageError("the output folder " + folder.string() + " cannot be written to (" + std::strerror(errno) +
                     "); choose another with -o");
  close(file);
  fs::remove(probe, error);
}

}  // namespace pvg
