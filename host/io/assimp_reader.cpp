#include "host/io/assimp_reader.hpp"

#include <assimp/BaseImporter.h>
#include <algorithm>
#include <cctype>

#include "host/io/collada_text.hpp"
#include "host/io/ply_header.hpp"

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

void prepare_reader(Assimp::Importer& importer, const std::filesystem::path& file) {
  if (ending_of(file) == ".dae") check_collada_text(file);
  if (ending_of(file) == ".ply") check_ply_header(file);
  Assimp::BaseImporter* const wanted = importer.GetImporter(ending_of(file).c_str());
  for (std::size_t i = importer.GetImporterCount(); i-- > 0;) {
    Assimp::BaseImporter* const reader = importer.GetImporter(i);
    if (reader == wanted) continue;
    importer.UnregisterLoader(reader);
    delete reader;  // ours from here on
  }
}

}  // namespace pvg
