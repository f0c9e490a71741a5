// The parts of task, scene and gripper files, each read from its section of the YAML file. Internal to the loaders.
#pragma once
#include <algorithm>
#include <numbers>
#include <string>
#include <vector>

#include "host/load/yaml_section.hpp"

namespace pvg {

constexpr double REACH = 100;  // nothing stands further from the origin [m]

void check_schema(YamlSection& root);

// `position` and `rotation` (roll, pitch, yaw about the fixed axes x, y, z in this order), of this section or of the
// one at `key`; absent: none
Pose read_pose(YamlSection& section);
Pose read_pose(YamlSection& parent, const std::string& key);

// Adds the section `materials`; a name that is there already is refused. textures: files named, or null: none allowed.
void add_materials(YamlSection& root, std::vector<VisualMaterial>& materials,
                   std::vector<std::filesystem::path>* textures);

SampledPose read_sampled_pose(YamlSection& section);  // `pose` of this section, numbers or ranges
// task_file.cpp; the gripper's materials become the task's
Effect read_effect(YamlSection& section);  // read_effect.cpp
RobotSection read_robot(YamlSection section);
GripperSection read_gripper(YamlSection& section, Task& task);
std::vector<VisualSection> read_visuals(YamlSection& section);  // the key `visuals`, if it is there
ObjectSection read_object(YamlSection& section);
ContactSettings read_contact(YamlSection& root);
SolverSettings read_solver(YamlSection& root, double largest_time_step);
BackgroundSection read_background(YamlSection section);
void read_light(YamlSection& section, Task& task);
CameraSection read_camera(YamlSection& section);
Vec3f read_color(YamlSection& section, const std::string& key, const Vec3f& otherwise, double high,
                 Unit unit = Unit::none);

RobotCell read_robot_cell(YamlSection& section, Task& task);  // `name`, `robot` and `gripper` of one of `robots`
std::vector<MotionElement> read_motion(YamlSection& root, const std::vector<RobotCell>& robots);
JointSection read_task_joint(YamlSection& section);
Condition read_condition(YamlSection& section, const std::vector<std::string>& robots, Condition::When otherwise);
Variation read_variation(YamlSection& section);

// What tasks and plain scenes share (task_file.cpp).
Task read_scene_sections(YamlSection& root, double largest_time_step);

// Names that refer to other parts of the file. bodies: names besides the objects and fingers (task_file.cpp)
void check_names(const YamlSection& root, const Task& task, const std::vector<std::string>& bodies);

template <typename T>
const T* find_named(const std::vector<T>& list, const std::string& name) {
  const auto at = std::find_if(list.begin(), list.end(), [&](const T& t) { return t.name == name; });
  return at == list.end() ? nullptr : &*at;
}

template <typename T>
void check_distinct(const YamlSection& root, const std::string& key, const std::vector<T>& list) {
  for (const T& a : list) {
    if (find_named(list, a.name) != &a) root.fail(key, "holds the name `" + a.name + "` twice");
  }
}

}  // namespace pvg
