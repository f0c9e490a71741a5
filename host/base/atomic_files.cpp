#include "host/base/atomic_files.hpp"

#include <fcntl.h>
#include <signal.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <chrono>
#include <cstring>
#include <mutex>
#include <random>
#include <regex>
#include <set>

#include "host/base/error.hpp"

namespace pvg {
namespace {

namespace fs = std::filesystem;

constexpr const char* PARTIAL = ".partial-";
constexpr std::size_t LONGEST_NAME = 100;  // of a target's name that its partial name repeats [bytes]
constexpr int MOST_TRIES = 100;            // at what others may undo in between
// a file that was not written to for so long is nobody's any more
constexpr std::chrono::minutes ABANDONED(10);

std::string host_name() {
  char name[256] = "";
  gethostname(name, sizeof name - 1);
  return name;
}

std::string random_bits() {
  std::random_device random;
  char text[20];
  std::snprintf(text, sizeof text, "%08x%08x", random(), random());
  return text;
}

fs::path partial_path(const fs::path& target, const std::string& ending) {
  return target.parent_path() / ("." + target.filename().string().substr(0, LONGEST_NAME) + PARTIAL +
                                 std::to_string(getpid()) + "." + host_name() + "." + random_bits() + ending);
}

// what this process has in the making
std::mutex unfinished_mutex;
std::set<fs::path> unfinished;

void begin(const fs::path& path) {
  const std::lock_guard lock(unfinished_mutex);
  unfinished.insert(path);
}
void end(const fs::path& path) {
  const std::lock_guard lock(unfinished_mutex);
  unfinished.erase(path);
}

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
      const int error = errno;
      close(file);
      errno = error;
      fail(path, "written");
    }
    done += std::size_t(n);
  }
  if (close(file) != 0) fail(path, "written");  // NFS says only here that there is no room
}

// The lock of a folder, which ends with the process: its file descriptor, -1 where somebody else holds it or the file
// system knows none; `is_held` says which.
int lock_folder(const fs::path& folder, bool& is_held) {
  const int file = open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  is_held = false;
  if (file < 0) return -1;
  if (flock(file, LOCK_EX | LOCK_NB) == 0) return file;
  is_held = errno == EWOULDBLOCK;
  close(file);
  return -1;
}

bool is_same_folder(int file, const fs::path& path) {
  struct stat locked, named;
  return fstat(file, &locked) == 0 && stat(path.c_str(), &named) == 0 && locked.st_ino == named.st_ino &&
         locked.st_dev == named.st_dev;
}

// Who made a partial file or folder, by its name.
struct Maker {
  pid_t process = 0;
  bool is_of_this_host = false, has_random_bits = false;
};

bool read_maker(const std::string& name, Maker& maker) {
  const std::size_t mark = name.rfind(PARTIAL);
  if (name.empty() || name[0] != '.' || mark == std::string::npos) return false;
  const char *number = name.data() + mark + std::strlen(PARTIAL), *last = name.data() + name.size();
  const auto parsed = std::from_chars(number, last, maker.process);
  if (parsed.ec != std::errc() || parsed.ptr == last || maker.process <= 0) return false;
  const std::string rest(parsed.ptr, last), host = "." + host_name();
  maker.has_random_bits = rest.starts_with(host + ".");
  maker.is_of_this_host = rest == host || maker.has_random_bits;
  return true;
}

bool is_alive(pid_t process) { return kill(process, 0) == 0 || errno == EPERM; }

// numbers of processes count on their machine alone, and in their container alone: a lock says more
bool is_abandoned(const fs::directory_entry& entry, const Maker& maker, int& lock) {
  if (!maker.is_of_this_host) return false;  // no way to ask
  std::error_code ignored;
  if (!maker.has_random_bits) return !is_alive(maker.process);
  if (!entry.is_directory(ignored))
    return fs::file_time_type::clock::now() - entry.last_write_time(ignored) > ABANDONED;
  bool is_held = false;
  lock = lock_folder(entry.path(), is_held);
  return lock >= 0 || (!is_held && !is_alive(maker.process));
}

}  // namespace

void write_text_atomically(const fs::path& path, const std::string& text) {
  PartialFile file(path);
  write_whole(file.path(), text);
  file.finish();
}

PartialFile::PartialFile(const fs::path& target)
    : target_(target), path_(partial_path(target, target.extension().string().substr(0, 16))) {
  begin(path_);
}

PartialFile::~PartialFile() {
  if (path_.empty()) return;
  std::error_code ignored;
  fs::remove(path_, ignored);
  end(path_);
}

void PartialFile::finish() {
  sync(path_);
  if (std::rename(path_.c_str(), target_.c_str()) != 0) fail(target_, "replaced");
  end(path_);
  path_.clear();
}

PartialFolder::PartialFolder(const fs::path& target) : target_(target), path_(partial_path(target, "")) {
  std::error_code error;
  for (int tries = 0;; ++tries) {
    if (!fs::create_directory(path_, error))
      throw UsageError(path_.string() + " could not be made: " + error.message());
    bool is_held = false;
    lock_ = lock_folder(path_, is_held);
    // one who tidies up may have taken it for a leftover in between
    if (tries == MOST_TRIES || (!is_held && (lock_ < 0 || is_same_folder(lock_, path_)))) break;
    if (lock_ >= 0) close(lock_);
    fs::remove_all(path_, error);
  }
  begin(path_);
}

PartialFolder::~PartialFolder() {
  if (!path_.empty()) {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
    end(path_);
  }
  if (lock_ >= 0) close(lock_);
}

void PartialFolder::finish() {
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(path_)) sync(entry.path());
  sync(path_);
  // another process may finish the same folder, of the same bits, between the two calls
  for (int tries = 0;; ++tries) {
    std::error_code ignored;
    fs::remove_all(target_, ignored);
    if (std::rename(path_.c_str(), target_.c_str()) == 0) break;
    if ((errno != ENOTEMPTY && errno != EEXIST) || tries == MOST_TRIES) fail(target_, "made");
  }
  end(path_);
  path_.clear();
  sync(target_.parent_path().empty() ? fs::path(".") : target_.parent_path());
}

std::string with_final_names(const std::string& message) {
  static const std::regex PATTERN("(^|[/ ])\\.([^/]*?)\\.partial-[0-9]+\\.[^/ ]*?\\.[0-9a-f]{16}(\\.[^/:; ]{1,16})?");
  std::string text;
  auto rest = message.cbegin();
  for (std::sregex_iterator found(message.begin(), message.end(), PATTERN), none; found != none; ++found) {
    const std::string name = (*found)[2], ending = (*found)[3];
    text.append(rest, found->prefix().second).append((*found)[1]).append(name);
    if (!name.ends_with(ending)) text.append(ending);
    rest = found->suffix().first;
  }
  return text.append(rest, message.cend());
}

void remove_unfinished() {
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
    Maker maker;
    if (!read_maker(entry.path().filename().string(), maker)) continue;
    int lock = -1;
    if (is_abandoned(entry, maker, lock)) n += fs::remove_all(entry.path(), ignored) > 0;
    if (lock >= 0) close(lock);
  }
  return n;
}

void make_writable_folder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  std::error_code ignored;
  if (error && fs::exists(folder, ignored)) throw UsageError("-o " + folder.string() + " is a file; name a folder");
  if (error) throw UsageError("the output folder " + folder.string() + " could not be made: " + error.message());
  const fs::path probe = partial_path(folder / "probe", "");
  const int file = open(probe.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0666);
  if (file < 0)
    throw UsageError("the output folder " + folder.string() + " cannot be written to (" + std::strerror(errno) +
                     "); choose another with -o");
  close(file);
  fs::remove(probe, error);
}

}  // namespace pvg
