// Robots' descriptions as scene files: MJCF (.xml) and URDF (.urdf) are translated to the grammar of scenes, which is
// then read as any other.
#pragma once
#include <filesystem>
#include <string>

namespace pvg {

// Whether the file's ending is .xml, .mjcf or .urdf.
bool is_robot_description(const std::filesystem::path& file);

// The scene file (YAML) that says the same. Paths in it are relative to `folder`, by default that of `file`. What
// MuJoCo damps on the rate of a joint alone, this does too; contact, solver and stops are those of scene files.
std::string imported_scene(const std::filesystem::path& file, const std::filesystem::path& folder = {});

// The text of a scene file, or of what it is translated to; empty where it cannot be read.
std::string scene_text(const std::filesystem::path& file);

}  // namespace pvg
