#include "host/base/files.hpp"

#include <fstream>
#include <iterator>

namespace pvg {

std::optional<std::string> read_whole_file(const std::filesystem::path& file) {
  std::error_code ignored;
  std::ifstream in(file, std::ios::binary);
  if (!in || std::filesystem::is_directory(file, ignored)) return std::nullopt;
  return std::string(std::istreambuf_iterator<char>(in), {});
}

}  // namespace pvg
