// Files and folders that appear complete or not at all: written under another name, brought to the disk, renamed.
#pragma once
#include <filesystem>
#include <string>

namespace pvg {

void write_text_atomically(const std::filesystem::path& path, const std::string& text);

// A folder in the making: PARENT/.NAME.partial-PID.HOST until finish() makes it PARENT/NAME, replacing what stood
// there. Without finish() it is removed with all that is in it.
class PartialFolder {
 public:
  explicit PartialFolder(const std::filesystem::path& target);
  ~PartialFolder();
  PartialFolder(const PartialFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }
  void finish();

 private:
  std::filesystem::path target_, path_;
};

// Removes what this process has in the making, from any thread, before it ends without further ado.
void remove_unfinished_folders();

// Removes the partial folders in `parent` whose process, of this machine, is gone; returns how many.
std::size_t remove_leftovers(const std::filesystem::path& parent);

// Makes a folder and those above it, and proves that it can be written to; UsageError otherwise.
void make_writable_folder(const std::filesystem::path& folder);

}  // namespace pvg
