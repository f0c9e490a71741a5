// Compiled programs on disk, for platforms that compile at every start (Intel's runtime for CPUs: 11 s of a processor).
// A file holds its whole key and a checksum: what was damaged, or stands under another key's name, is not found. Files
// appear complete or not at all. Nothing here throws: a folder that cannot be written keeps nothing.
#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace pvg {

class ProgramCache {
 public:
  explicit ProgramCache(std::filesystem::path folder) : folder_(std::move(folder)) {}

  bool keeps_programs() const { return !folder_.empty(); }
  // key: all that the compiled program depends on
  std::optional<std::vector<unsigned char>> find(const std::string& key) const;
  void keep(const std::string& key, std::span<const unsigned char> program) const;
  std::filesystem::path file_of(const std::string& key) const;

 private:
  std::filesystem::path folder_;
};

// $XDG_CACHE_HOME/phyvisgen/programs, else ~/.cache/phyvisgen/programs; empty where neither is known.
std::filesystem::path program_cache_folder();

// Whether the driver keeps compiled programs itself.
bool platform_keeps_programs(const std::string& platform);

}  // namespace pvg
