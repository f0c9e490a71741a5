#include "pipeline/commands/data_folder.hpp"

namespace pvg {

std::filesystem::path data_folder() {
  std::error_code ignored;
  const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe", ignored);
  const std::filesystem::path installed = program.parent_path().parent_path() / "share/phyvisgen/data";
  return std::filesystem::exists(installed, ignored) ? installed : std::filesystem::path(PVG_DATA_SOURCE_FOLDER);
}

}  // namespace pvg
