#include "host/device/program_cache.hpp"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <string_view>

#include "host/base/hash.hpp"

namespace fs = std::filesystem;

namespace pvg {
namespace {

// The head of a file; key and program follow.
struct Head {
  char magic[8];
  std::uint64_t key_bytes, program_bytes, checksum;
};
constexpr char MAGIC[8] = {'P', 'V', 'G', 'P', 'R', 'G', '1', '\n'};

std::string_view as_text(std::span<const unsigned char> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

}  // namespace

fs::path ProgramCache::file_of(const std::string& key) const {
  char name[32];
  std::snprintf(name, sizeof name, "%016llx.bin", static_cast<unsigned long long>(fnv1a(key)));
  return folder_ / name;
}

std::optional<std::vector<unsigned char>> ProgramCache::find(const std::string& key) const {
  if (folder_.empty()) return std::nullopt;
  std::ifstream in(file_of(key), std::ios::binary);
  Head head{};
  if (!in.read(reinterpret_cast<char*>(&head), sizeof head)) return std::nullopt;
  if (std::memcmp(head.magic, MAGIC, sizeof MAGIC) != 0 || head.key_bytes != key.size()) return std::nullopt;
  const std::string rest{std::istreambuf_iterator<char>(in), {}};
  if (rest.size() < key.size() || rest.size() - key.size() != head.program_bytes) return std::nullopt;
  if (fnv1a(rest) != head.checksum || rest.compare(0, key.size(), key) != 0) return std::nullopt;
  return std::vector<unsigned char>(rest.begin() + std::ptrdiff_t(key.size()), rest.end());
}

void ProgramCache::keep(const std::string& key, std::span<const unsigned char> program) const {
  if (folder_.empty() || program.empty()) return;
  std::error_code failed;
  fs::create_directories(folder_, failed);
  const fs::path file = file_of(key);
  // a name of its own for each process and thread that may write the same program at once
  const fs::path unfinished = file.string() + "." + std::to_string(getpid()) + "." +
                              std::to_string(reinterpret_cast<std::uintptr_t>(&failed)) + ".part";
  Head head{{}, key.size(), program.size(), fnv1a(as_text(program), fnv1a(key))};
  std::copy(std::begin(MAGIC), std::end(MAGIC), head.magic);
  std::ofstream out(unfinished, std::ios::binary);
  out.write(reinterpret_cast<const char*>(&head), sizeof head);
  out << key << as_text(program);
  out.close();
  if (out) fs::rename(unfinished, file, failed);
  if (!out || failed) fs::remove(unfinished, failed);
}

fs::path program_cache_folder() {
  const auto folder = [](const char* variable) -> fs::path {
    const char* value = std::getenv(variable);
    // the XDG specification: a path that is not absolute does not count
    return value && fs::path(value).is_absolute() ? fs::path(value) : fs::path();
  };
  if (const fs::path cache = folder("XDG_CACHE_HOME"); !cache.empty()) return cache / "phyvisgen" / "programs";
  if (const fs::path home = folder("HOME"); !home.empty()) return home / ".cache" / "phyvisgen" / "programs";
  return {};
}

bool platform_keeps_programs(const std::string& platform) {
  constexpr std::array<std::string_view, 4> names = {"Portable Computing Language", "NVIDIA CUDA", "rusticl", "Clover"};
  return std::find(names.begin(), names.end(), platform) != names.end();
}

}  // namespace pvg
