// assimp with the reader of one format alone: with all of them it goes by what a file's first bytes look like where the
// one of its ending refuses it, and some of the others can be made to ask for any amount of memory.
#pragma once
#include <assimp/Importer.hpp>
#include <filesystem>
#include <string>

#include "host/base/child_process.hpp"

namespace pvg {

// ".OBJ" as ".obj"
std::string ending_of(const std::filesystem::path& file);

// Of .obj, .stl, .ply and .dae files.
bool is_read_by_assimp(const std::filesystem::path& file);

// More than it needs for a sound file of this size.
ProcessLimits limits_to_read(const std::filesystem::path& file);

// Leaves the reader of the file's ending.
void keep_one_reader(Assimp::Importer& importer, const std::filesystem::path& file);

}  // namespace pvg
