// Poses, meshes and geoms of an MJCF file. Internal to its reader.
#pragma once
#include "host/robot/mjcf_elements.hpp"
#include "host/robot/multibody.hpp"

namespace pvg::mjcf {

// What <compiler> says.
struct Compiler {
  bool counts_degrees = true;
  bool has_automatic_limits = true;
  std::string euler_sequence = "xyz";
  std::string inertia_from_geoms = "auto";
  std::filesystem::path mesh_folder;
  double angle(double number) const;  // of the file -> [rad]
};

Compiler read_compiler(const TiXmlElement& root, const std::filesystem::path& file);

// `pos` and one of quat, axisangle, euler, xyaxes, zaxis
Pose read_pose(const Element& element, const Compiler& compiler);

struct Mesh {
  std::filesystem::path file;
  double scale = 1;
};
using Meshes = std::map<std::string, Mesh>;
Meshes read_meshes(const TiXmlElement& root, const Defaults& defaults, const Compiler& compiler,
                   const std::string& file);

struct Geom {
  MultibodyShape shape;
  bool is_plane = false;
  double mass = 0;              // [kg]
  Vec3 center = Vec3::Zero();   // of mass, in the body's frame [m]
  Mat3 inertia = Mat3::Zero();  // about it, along the axes of the body's frame [kg m^2]
  double friction = 1;
  int type_bits = 1, affinity_bits = 1;  // two geoms collide where the type of one shares a bit with the affinity of
                                         // the other
};

// has_mass: the body's inertia follows from its geoms
Geom read_geom(const Element& element, const Compiler& compiler, const Meshes& meshes, bool has_mass);

}  // namespace pvg::mjcf
