// What every fuzz program does with its input: it becomes a file in a folder of this process, beside copies of
// tests/fuzz/files, which it may name; the loader under test reads it. A loader may refuse a file with UsageError or
// Failure and nothing else: any other exception ends the program, as a crash, a hang or too much memory does.
#pragma once
#include <unistd.h>

#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include "host/base/error.hpp"

namespace pvg {

// Made once per process, gone at its end.
class InputFolder {
 public:
  InputFolder() : path_(std::filesystem::temp_directory_path() / ("pvg_fuzz_" + std::to_string(getpid()))) {
    std::filesystem::copy(PVG_FUZZ_FILES, path_);
    setenv("PATH", "", 1);  // tetgen is not run
  }
  ~InputFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  std::filesystem::path write(const std::string& name, const std::uint8_t* data, std::size_t size) const {
    std::ofstream(path_ / name, std::ios::binary).write(reinterpret_cast<const char*>(data), std::streamsize(size));
    return path_ / name;
  }

 private:
  std::filesystem::path path_;
};

inline std::filesystem::path input_file(const std::string& name, const std::uint8_t* data, std::size_t size) {
  static const InputFolder folder;
  return folder.write(name, data, size);
}

template <typename Call>
void may_refuse(const Call& call) {
  try {
    call();
  } catch (const UsageError&) {
  } catch (const Failure&) {
  }
}

}  // namespace pvg
