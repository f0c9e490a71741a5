// A task and a number of an episode -> the Scene at its start. All chance is drawn here, by a counter-based generator
// from (seed, episode, name of the quantity) alone: the result depends on nothing that ran before.
#pragma once
#include <cstdint>

#include "host/model/task.hpp"

namespace pvg {

// One drawn number: "beaker/x" -> 0.513 [SI].
struct SampledValue {
  std::string name;
  double value = 0;
};

// Where a robot of the task is in the Scene.
struct BuiltRobot {
  std::string name;                              // as in Task::more_robots, or empty
  std::vector<int> arm;                          // of Scene::joints, base to flange
  std::vector<int> gripper;                      // of Scene::joints
  int flange = -1;                               // rigid body that the flange is part of
  int gripper_base = -1;                         // rigid body
  Pose flange_to_tool = Pose::Identity();        // tool frame in the frame of the link `robot.flange`
  std::vector<int> arm_bodies, gripper_bodies;   // of Scene::rigid_bodies, without fingers
  std::vector<int> soft_fingers, rigid_fingers;  // of Scene::soft_bodies; of Scene::rigid_bodies where they are rigid
};

// A scene and what the planner and the record need to know about it beyond the Scene itself.
struct TaskScene {
  Scene scene;
  std::vector<SampledValue> sampled;      // only quantities whose range is not a point
  std::vector<BuiltRobot> robots;         // as robots_of(task)
  std::vector<Disturbance> disturbances;  // drawn, in their order
};

// Evenly distributed in [0, 1), a function of its three arguments alone.
double uniform_number(std::uint64_t seed, std::uint64_t episode, const std::string& name);

TaskScene build_scene(const Task& task, std::uint64_t seed, std::uint64_t episode);

// The same with every drawn number in the middle of its range.
TaskScene build_scene_at_middle(const Task& task);

// A plain scene file (scene_file.hpp); starts at the middle of every range.
Scene load_scene(const std::filesystem::path& file);
// The same of a changed text of the file: paths are relative to its folder, messages name the file (scene_file.cpp).
Scene load_changed_scene(const std::filesystem::path& file, const std::string& text);

// Adds what is seen of one body: a copy of `body` for each section, with its mesh and material. size: factor on meshes
// that are no glTF scenes of their own.
void add_visuals(Scene& scene, const std::vector<VisualSection>& sections, const Visual& body, double size = 1);

// What a glTF file shows, with its cameras and KHR_lights_punctual; left_out: what it holds besides, a sentence each.
Scene gltf_as_scene(const std::filesystem::path& file, std::vector<std::string>* left_out);

// The task as it was run, every default and every drawn number spelled out, as YAML for the record.
std::string resolved_yaml(const Task& task, const TaskScene& built);

}  // namespace pvg
