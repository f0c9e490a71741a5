// What in a COLLADA file (.dae) keeps assimp busy without end or takes all memory: elements too deep in each other,
// lists of numbers that hold anything else, numbers of entries beyond any sense.
#pragma once
#include <filesystem>

namespace pvg {

// UsageError, which names the file and what is wrong.
void check_collada_text(const std::filesystem::path& file);

}  // namespace pvg
