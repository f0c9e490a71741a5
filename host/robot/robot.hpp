// A robot as its URDF says it: a tree of links and joints, as plain structs. SI units, radians.
#pragma once
#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "host/model/scene.hpp"

namespace pvg {

struct LinkVisual {
  std::string name;                     // file of the mesh without its folder and ending, or the kind of primitive
  VisualMesh mesh;                      // in the link's frame
  std::string material;                 // its name in the URDF, empty: none
  Vec3f color = Vec3f::Constant(0.6f);  // linear Rec. 709; URDF colours are read as sRGB
};

struct RobotLink {
  std::string name;
  double mass = 0;                     // [kg]; 0: the URDF gives none, allowed where a fixed joint carries the link
  Vec3 center_of_mass = Vec3::Zero();  // in the link's frame [m]
  Mat3 inertia = Mat3::Zero();         // about the centre of mass, axes of the link's frame [kg m^2]
  TriangleMesh collision;              // all collision shapes together, in the link's frame; closed; may be empty
  std::vector<LinkVisual> visuals;
};

// Position-dependent velocity limits: the joint must slow down before its ends,
//   v <=  min(v_max, max(0, -offset + sqrt(max(0, slope (upper - q)))))
//   v >= -min(v_max, max(0, -offset + sqrt(max(0, slope (lower + q)))))        [rad/s]
// (the form of libfranka's rate_limiting.h; mind the sign of `lower`)
struct VelocityEnvelope {
  double offset = 0;            // [rad/s]
  double slope = 0;             // [rad/s^2]
  double upper = 0, lower = 0;  // [rad]
};

struct RobotJoint {
  std::string name;
  Joint::Type type = Joint::Type::fixed;  // fixed, revolute or prismatic
  int parent = -1, child = -1;            // links
  Pose origin = Pose::Identity();         // joint frame, which is the child's frame at q = 0, in the parent's frame
  Vec3 axis = Vec3::UnitZ();              // in the joint frame, unit
  double lower = 0, upper = 0;            // [rad or m]; both 0: none (a continuous joint)
  double velocity = 0;                    // limit [rad/s or m/s]
  double effort = 0;                      // limit [N m or N]
  double acceleration = 0;                // limit [rad/s^2 or m/s^2]; 0: the URDF gives none
  double jerk = 0;                        // limit [rad/s^3 or m/s^3]; 0: the URDF gives none
  std::optional<VelocityEnvelope> envelope;
};

struct RobotModel {
  std::string name;
  std::vector<RobotLink> links;                  // parents before children; links[0] is the base
  std::vector<RobotJoint> joints;                // parents before children; joints[i].child == i + 1
  std::vector<int> actuated;                     // joints that move, in that order: these make up q [n_actuated]
  std::vector<std::array<int, 2>> noncolliding;  // pairs of links that cannot or need not collide, besides jointed ones
  int link(const std::string& name) const;       // index, or UsageError
};

// Reads a URDF and its meshes (STL, OBJ, DAE, PLY; a relative path is relative to the URDF's folder, and so is what
// follows package://NAME/, looked for in the URDF's folder and those above it). UsageErrors name file, joint or link.
// Beyond plain URDF it understands acceleration="" and jerk="" of <limit>, <velocity_envelope offset="" slope=""
// upper="" lower=""/> in a joint, and <disable_collisions link1="" link2=""/> (as in SRDF) in the robot.
RobotModel load_urdf(const std::filesystem::path& file);

}  // namespace pvg
