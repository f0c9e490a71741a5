// Bodies, joints and drives as a file of another simulator (MJCF) or a robot's description (URDF) says them, before
// they become a scene. SI units, radians; poses to the world in the configuration where the model starts.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "host/model/physical_scene.hpp"

namespace pvg {

struct MultibodyShape {
  enum class Kind { box, sphere, capsule, cylinder, ellipsoid, mesh, link };
  Kind kind = Kind::box;
  Vec3 size = Vec3::Zero();      // box, ellipsoid: half of each width; others: radius, half length [m]
  std::filesystem::path file;    // of a mesh; of a link its URDF
  std::string link;              // of that URDF
  double scale = 1;              // of a mesh
  Pose pose = Pose::Identity();  // in the body's frame
};

struct MultibodyBody {
  enum class Kind { moving, fixed, half_space };
  std::string name;
  Kind kind = Kind::moving;
  Pose pose = Pose::Identity();        // of a half space: its surface is z = 0
  double mass = 0;                     // of those that move [kg]
  Vec3 center_of_mass = Vec3::Zero();  // in the body's frame [m]
  Mat3 inertia = Mat3::Zero();         // about the centre of mass, axes of the body's frame [kg m^2]
  std::vector<MultibodyShape> shapes;  // what collides; empty: nothing
  double friction = 0.5;
};

struct MultibodyJoint {
  Joint joint;                // parent -1: the world
  double armature = 0;        // [kg m^2 or kg]
  double coulomb = 0;         // friction [N m or N]
  double spring = 0;          // [N m/rad or N/m]
  double spring_preload = 0;  // effort at q = 0 [N m or N]
  double actuator_lag = 0;    // time constant [s]
};

// Where a joint starts: at `rest`, or at the end of its limits that is nearest.
double start_within(const Joint& joint, double rest);

// The child's frame in the parent's at Joint::initial.
Pose start_of_child(const Joint& joint);

struct Multibody {
  std::string name;
  double time_step = 0.002;  // [s]
  Vec3 gravity = Vec3(0, 0, -9.81);
  std::vector<MultibodyBody> bodies;
  std::vector<MultibodyJoint> joints;
  std::vector<std::array<int, 2>> noncolliding;  // bodies, besides jointed ones
};

// MuJoCo's MJCF, with <include> and <default>. UsageErrors name file, line and element, and what is not supported:
// everything that would change the motion and that Multibody cannot say.
Multibody read_mjcf(const std::filesystem::path& file);

// A URDF whose base link does not move.
Multibody read_urdf_multibody(const std::filesystem::path& file);

}  // namespace pvg
