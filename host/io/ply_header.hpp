// What a PLY file announces. assimp believes it: an element without a number keeps it busy without end, one with a
// large number takes all memory. So the announcement is read here first.
#pragma once
#include <filesystem>

namespace pvg {

// UsageError, which names file and line, where the header is not that of a PLY file 1.0 or announces more elements than
// the file has bytes.
void check_ply_header(const std::filesystem::path& file);

}  // namespace pvg
