// Where the program's own scenes and tasks lie.
#pragma once
#include <filesystem>

namespace pvg {

// data/ of the installation, else of the source tree
std::filesystem::path data_folder();

}  // namespace pvg
