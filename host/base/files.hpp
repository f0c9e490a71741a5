// The content of a file.
#pragma once
#include <filesystem>
#include <optional>
#include <string>

namespace pvg {

// All bytes of a file; nothing where it cannot be read, or is a folder.
std::optional<std::string> read_whole_file(const std::filesystem::path& file);

}  // namespace pvg
