// The vertices of a PLY file as a table of named numbers, whatever their names and types: what readers of meshes drop.
// ASCII, little and big endian; lists of other elements are skipped by not being read: vertices must come first.
#pragma once
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace pvg {

struct PlyTable {
  std::size_t n = 0;                                 // vertices
  std::map<std::string, std::vector<float>> column;  // [n] each
};

// Names of the vertices' properties, from the header alone; empty: the file is no PLY.
std::vector<std::string> ply_properties(const std::filesystem::path& file);

// UsageErrors name the file and what is wrong: no PLY, cut off, a list among the vertices' properties.
PlyTable read_ply_table(const std::filesystem::path& file);

}  // namespace pvg
