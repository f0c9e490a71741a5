#include "host/io/atomic_files.hpp"

#include <fcntl.h>
#include <signal.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <cstring>

#include "host/base/error.hpp"

namespace pvg {
namespace {

namespace fs = std::filesystem;

constexpr const char* PARTIAL = ".partial-";

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
  const fs::path partial = path.parent_path() / ("." + path.filename().string() + PARTIAL + std::to_string(getpid()));
  write_whole(partial, text);
  if (std::rename(partial.c_str(), path.c_str()) != 0) fail(path, "replaced");
}

PartialFolder::PartialFolder(const fs::path& target)
    : target_(target),
      path_(target.parent_path() / ("." + target.filename().string() + PARTIAL + std::to_string(getpid()))) {
  std::error_code error;
  fs::remove_all(path_, error);
  if (!fs::create_directory(path_, error)) throw UsageError(path_.string() + " could not be made: " + error.message());
}

PartialFolder::~PartialFolder() {
  std::error_code ignored;
  if (!path_.empty()) fs::remove_all(path_, ignored);
}

void PartialFolder::finish() {
  for (const fs::directory_entry& entry : fs::directory_iterator(path_)) sync(entry.path());
  sync(path_);
  std::error_code ignored;
  fs::remove_all(target_, ignored);
  if (std::rename(path_.c_str(), target_.c_str()) != 0) fail(target_, "made");
  path_.clear();
  sync(target_.parent_path());
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
    if (parsed.ec != std::errc() || parsed.ptr != name.data() + name.size() || owner <= 0) continue;
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
  const fs::path probe = folder / (".probe" + std::string(PARTIAL) + std::to_string(getpid()));
  const int file = open(probe.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0666);
  if (file < 0)
    throw UsageError("the output folder " + folder.string() + " cannot be written to (" + std::strerror(errno) +
                     "); choose another with -o");
  close(file);
  fs::remove(probe, error);
}

}  // namespace pvg
