// The parts of task, scene and gripper files, each read from its section of the YAML file. Internal to the loaders.
#pragma once
#include <algorithm>
#include <numbers>
#include <string>
#include <vector>

#include "host/base/names.hpp"
#include "host/load/tables.hpp"

namespace pvg {

void check_schema(YamlSection& root);

// Adds the section `materials`; a name that is there already is refused. textures: files named, or null: none allowed.
void add_materials(YamlSection& root, std::vector<VisualMaterial>& materials,
                   std::vector<std::filesystem::path>* textures);

// The same material with the names of its textures' files.
MaterialSection with_files(const VisualMaterial& material, const std::vector<std::filesystem::path>& textures);

// Its materials become the task's, whose own win (task_file.cpp).
void add_gripper_materials(const GripperSection& gripper, Task& task);
void read_light(YamlSection& section, Task& task);

void add_robot_cell(const YamlSection& section, RobotCell cell, Task& task);  // one of `robots` (task_file.cpp)
std::vector<MotionElement> read_motion(YamlSection& root, const std::vector<RobotCell>& robots);

// What tasks and plain scenes share (task_file.cpp).
Task read_scene_sections(YamlSection& root, double largest_time_step);

// Names that refer to other parts of the file. bodies: names besides the objects and fingers (task_file.cpp)
void check_names(const YamlSection& root, const Task& task, const std::vector<std::string>& bodies);

template <typename T>
void check_distinct(const YamlSection& root, const std::string& key, const std::vector<T>& list) {
  for (const T& a : list) {
    if (find_named(list, a.name) != &a) root.fail(key, "holds the name `" + a.name + "` twice");
  }
}

}  // namespace pvg
