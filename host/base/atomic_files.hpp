// Files and folders that appear complete or not at all: written under another name, brought to the disk, renamed.
//
// What is in the making is called .NAME.partial-PID.HOST.RANDOM, plus the ending that a file will have. Containers may
// share a host name and count their processes alike, so the random bits keep two of them apart, and a lock that ends
// with the process tells whether somebody still works on a folder.
#pragma once
#include <filesystem>
#include <string>

namespace pvg {

void write_text_atomically(const std::filesystem::path& path, const std::string& text);

// A folder in the making until finish() makes it PARENT/NAME, replacing what stood there. Without finish() it is
// removed with all that is in it.
class PartialFolder {
 public:
  explicit PartialFolder(const std::filesystem::path& target);
  ~PartialFolder();
  PartialFolder(const PartialFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }
  void finish();

 private:
  std::filesystem::path target_, path_;
  int lock_ = -1;  // file descriptor that holds the lock
};

// A file in the making, written by others under path(), until finish() gives it its name. Without finish() it is
// removed.
class PartialFile {
 public:
  explicit PartialFile(const std::filesystem::path& target);
  ~PartialFile();
  PartialFile(const PartialFile&) = delete;
  const std::filesystem::path& path() const { return path_; }
  void finish();

 private:
  std::filesystem::path target_, path_;
};

// A message in which what is in the making has the name that it will have, which is the one that was asked for.
std::string with_final_names(const std::string& message);

// Removes what this process has in the making, from any thread, before it ends without further ado.
void remove_unfinished();

// Removes the partial files and folders in `parent` that nobody works on any more; returns how many.
std::size_t remove_leftovers(const std::filesystem::path& parent);

// Makes a folder and those above it, and proves that it can be written to; UsageError otherwise.
void make_writable_folder(const std::filesystem::path& folder);

}  // namespace pvg
