#include "host/base/outputs.hpp"

#include <fcntl.h>
#include <fnmatch.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <mutex>
#include <set>
#include <utility>

#include "host/base/atomic_files.hpp"
#include "host/base/error.hpp"

namespace pvg {
namespace {

namespace fs = std::filesystem;

using FileId = std::pair<dev_t, ino_t>;  // one file, whatever its names are

std::mutex read_mutex;
std::set<FileId> files_read;

bool find_id(const fs::path& file, FileId& id) {
  struct stat info;
  if (stat(file.c_str(), &info) != 0) return false;
  id = {info.st_dev, info.st_ino};
  return true;
}

fs::path whole_path(const fs::path& path) {
  std::error_code error;
  fs::path whole = fs::weakly_canonical(fs::absolute(path), error);
  if (error) whole = fs::absolute(path).lexically_normal();
  return whole.filename().empty() ? whole.parent_path() : whole;  // without a slash at its end
}

bool lies_in(const fs::path& inner, const fs::path& outer) {
  return std::mismatch(outer.begin(), outer.end(), inner.begin(), inner.end()).first == outer.end();
}

std::string joined(const std::vector<std::string>& words) {
  std::string all;
  for (const std::string& word : words) all += (all.empty() ? "" : ", ") + word;
  return all;
}

}  // namespace

bool is_file(const fs::path& file) {
  std::error_code ignored;
  return fs::is_regular_file(file, ignored);
}

void remember_read(const fs::path& file) {
  FileId id;
  if (!find_id(file, id)) return;
  const std::lock_guard lock(read_mutex);
  files_read.insert(id);
}

void check_is_not_read(const fs::path& output) {
  FileId id;
  if (!find_id(output, id)) return;
  const std::lock_guard lock(read_mutex);
  if (files_read.contains(id))
    throw UsageError(output.string() + " is a file that this command reads; choose another name for the output");
}

void check_output_file(const fs::path& output, const std::vector<std::string>& endings, const std::string& option) {
  const std::string given = option + " " + output.string();
  if (!endings.empty() && std::find(endings.begin(), endings.end(), output.extension().string()) == endings.end())
    throw UsageError(given + ": the name must end in " + joined(endings));
  check_is_not_read(output);
  std::error_code ignored;
  const fs::file_status status = fs::status(output, ignored);
  if (fs::is_directory(status)) throw UsageError(given + " is a folder; name a file");
  if (fs::exists(status) && !fs::is_regular_file(status))
    throw UsageError(given + " is a device or a pipe; name a file");
  const fs::path folder = output.parent_path();
  if (!folder.empty() && !fs::is_directory(folder, ignored))
    throw UsageError(given + ": there is no folder " + folder.string() + "; make it first");
  // the name itself is tried, as it may be too long
  const bool was_there = fs::exists(status);
  const int file = open(output.c_str(), O_WRONLY | O_CLOEXEC | (was_there ? 0 : O_CREAT | O_EXCL), 0666);
  if (file < 0) throw UsageError(given + " cannot be written: " + std::strerror(errno));
  close(file);
  if (!was_there) fs::remove(output, ignored);
}

void check_output_folder(const fs::path& output, const std::vector<std::string>& ours, const std::string& what) {
  const std::string given = "-o " + output.string();
  std::error_code ignored;
  if (fs::exists(output, ignored) && !fs::is_directory(output, ignored))
    throw UsageError(given + " is a file; name a folder");
  make_writable_folder(fs::absolute(output).parent_path());
  for (const fs::directory_entry& entry : fs::directory_iterator(output, ignored)) {
    const std::string name = entry.path().filename().string();
    const auto is_name = [&](const std::string& pattern) { return fnmatch(pattern.c_str(), name.c_str(), 0) == 0; };
    if (std::none_of(ours.begin(), ours.end(), is_name))
      throw UsageError(given + " holds " + name + ", which is none of what " + what +
                       " writes and would be lost; choose another folder");
  }
}

namespace {
constexpr const char* CHOOSE = "; choose a folder beside it with -o";
}

void check_not_within(const fs::path& output, const fs::path& input, const std::string& what) {
  const fs::path out = whole_path(output), in = whole_path(input);
  if (out == in) throw UsageError("-o " + output.string() + " is the folder that " + what + " reads" + CHOOSE);
  if (lies_in(out, in))
    throw UsageError("-o " + output.string() + " lies inside " + input.string() + ", which " + what + " reads" +
                     CHOOSE);
}

void check_apart(const fs::path& output, const fs::path& input, const std::string& what) {
  check_not_within(output, input, what);
  if (lies_in(whole_path(input), whole_path(output)))
    throw UsageError(input.string() + ", which " + what + " reads, lies inside -o " + output.string() + CHOOSE);
}

}  // namespace pvg
