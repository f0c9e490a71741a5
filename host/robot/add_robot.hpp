// A RobotModel becomes bodies, joints, drives and visuals of a Scene.
#pragma once
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "host/robot/kinematics.hpp"

namespace pvg {

struct RobotOptions {
  std::string prefix = {};                   // put before the names of bodies, joints and visuals
  double stiffness = 1e5;                    // of revolute joints' drives [N m/rad]
  double damping = 0;                        // [N m s/rad]
  double prismatic_stiffness = 2e4;          // of prismatic joints' drives [N/m]
  double prismatic_damping = 0;              // [N s/m]
  std::map<std::string, Drive> drives = {};  // by the URDF's joint name; replaces the above entirely
  bool compensates_gravity = true;
  bool limits_effort = true;        // cut the drives at the URDF's effort limits
  bool keeps_fixed_joints = false;  // else links behind fixed joints become part of their parent's body
  std::optional<std::vector<std::string>> collision_links = {};  // links that collide; absent: all that have a mesh
  double friction = 0.5;
  double affine_modulus = 1e9;                // [Pa]
  std::map<std::string, int> materials = {};  // URDF material name -> Scene::materials; others are added, diffuse
  int material = -1;                          // of Scene::materials, for all visuals; -1: by name or by colour
  std::string part = "robot";                 // label of the visuals in segmentation masks
};

// Where a robot's links and joints are in the Scene.
struct AddedRobot {
  std::vector<int> body;           // [n_links] rigid body that the link became or is part of
  std::vector<Pose> link_in_body;  // [n_links] link frame in that body's frame
  std::vector<int> joints;         // [n_actuated] of Scene::joints, the order of q
};

// The base link is fixed to the world at `base`.
AddedRobot add_robot(Scene& scene, const RobotModel& model, const Pose& base, const VectorXd& q,
                     const RobotOptions& options = {});

// The base link is fixed by a fixed joint to a body of the scene. base: its frame in that body's frame.
AddedRobot attach_robot(Scene& scene, int parent_body, const Pose& base, const RobotModel& model, const VectorXd& q,
                        const RobotOptions& options = {});

}  // namespace pvg
