// The parts that build_scene puts together. They throw a UsageError that names the part of the task.
#pragma once
#include <string>

#include "host/load/build_scene.hpp"

namespace pvg {

// index into scene.materials
int material_index(const Scene& scene, const std::string& name);

// the body of an object or a rigid finger: its surface in the object's size, and mass and inertia of it when solid
RigidBody rigid_body(const ObjectSection& object, const Pose& pose);

// The surface of an object without visuals in plain grey, so that nothing is there and unseen.
void add_plain_visual(Scene& scene, const std::filesystem::path& mesh, const Visual& body, double size);

// A display on a rigid body of the scene: its face, its picture of the start.
void add_display(Scene& scene, const Display& display, int rigid, double size);

// the captured room, if the task has one
void add_background(Scene& scene, const BackgroundSection& background);

// a robot with its gripper, at its home position; appended to built.robots
void add_arm(TaskScene& built, const RobotCell& cell);

}  // namespace pvg
