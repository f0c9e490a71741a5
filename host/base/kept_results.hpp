// Results of slow functions of files, so that a process which builds many scenes of the same parts reads each part
// once. A result is kept under everything it depends on; a file that changed is another key.
#pragma once
#include <cstddef>
#include <filesystem>
#include <map>
#include <mutex>
#include <string>

namespace pvg {

// Path, size and time of the last change; empty where there is no such file.
inline std::string file_key(const std::filesystem::path& file) {
  std::error_code error;
  const auto size = std::filesystem::file_size(file, error);
  if (error) return "";
  const auto time = std::filesystem::last_write_time(file, error);
  if (error) return "";
  return std::filesystem::absolute(file).string() + "\n" + std::to_string(size) + "\n" +
         std::to_string(time.time_since_epoch().count());
}

// What threads share; nothing is observed of it but the time that it saves. No more than `most` results are kept.
template <class Result>
class KeptResults {
 public:
  explicit KeptResults(std::size_t most) : most_(most) {}

  // The result for the key, made by `make` where there is none yet; of an empty key it is made anew.
  template <class Make>
  Result of(const std::string& key, const Make& make) {
    if (!key.empty()) {
      const std::lock_guard lock(mutex_);
      if (const auto known = results_.find(key); known != results_.end()) return known->second;
    }
    Result result = make();
    if (!key.empty()) {
      const std::lock_guard lock(mutex_);
      if (results_.size() >= most_) results_.clear();
      results_.emplace(key, result);
    }
    return result;
  }

 private:
  std::size_t most_;
  std::mutex mutex_;
  std::map<std::string, Result> results_;
};

}  // namespace pvg
