// Reads task, scene and gripper files (YAML) into plain structs. Every number is checked for range and unit; unknown,
// missing and doubled keys and missing files are UsageErrors that name file, line and key.
#pragma once
#include "host/model/task.hpp"

namespace pvg {

Task load_task(const std::filesystem::path& file);

// A YAML file with a `motion` is a task; others are scenes.
bool is_task_file(const std::filesystem::path& file);

GripperSection load_gripper(const std::filesystem::path& file);

// What resolved_yaml (build_scene.hpp) wrote, without meshes of cloths.
// file: its paths are relative to its folder; messages name it.
Task read_resolved(const std::string& text, const std::filesystem::path& file);

}  // namespace pvg
