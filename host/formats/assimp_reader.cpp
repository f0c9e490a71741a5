#include "host/formats/assimp_reader.hpp"

#include <assimp/BaseImporter.h>
#include <algorithm>
#include <cctype>

namespace pvg {

std::string ending_of(const std::filesystem::path& file) {
  std::string s = file.extension().string();
  std::transform(s.begin(), s.end(), s.begin(), [](unsigned char c) { return std::tolower(c); });
  return s;
}

bool is_read_by_assimp(const std::filesystem::path& file) {
  const std::string ending = ending_of(file);
  return ending == ".obj" || ending == ".stl" || ending == ".ply" || ending == ".dae";
}

ProcessLimits limits_to_read(const std::filesystem::path& file) {
  const std::uintmax_t size = std::filesystem::file_size(file);
  return {(std::uintmax_t(512) << 20) + 64 * size, 5 + (size >> 20)};
}

void keep_one_reader(Assimp::Importer& importer, const std::filesystem::path& file) {
  Assimp::BaseImporter* const wanted = importer.GetImporter(ending_of(file).c_str());
  for (std::size_t i = importer.GetImporterCount(); i-- > 0;) {
    Assimp::BaseImporter* const reader = importer.GetImporter(i);
    if (reader == wanted) continue;
    importer.UnregisterLoader(reader);
    delete reader;  // ours from here on
  }
}

}  // namespace pvg
