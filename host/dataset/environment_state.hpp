// What a policy sees of objects and cloths as numbers, in packed sets (observation.environment_state) and from `serve`
// (environment_state): first of each rigid object its pose, then of each cloth its keypoints.
//
// Keypoints of a cloth are the points of its mesh that rest nearest to the corners and edge middles of the rectangle
// around it: the bounding box of its rest shape in the two axes of its own frame in which it is longest (ties: x before
// y before z), u and v in this order. They go around from the corner of least u and v, first along u:
//
//   corner_3   edge_2   corner_2
//   edge_3              edge_1      v
//   corner_0   edge_0   corner_1    |_ u
#pragma once
#include <array>
#include <span>
#include <string>
#include <vector>

#include "host/geometry/mesh.hpp"
#include "host/model/physical_scene.hpp"

namespace pvg {

inline constexpr std::array<const char*, 8> KEYPOINT_NAMES = {"corner_0", "edge_0", "corner_1", "edge_1",
                                                              "corner_2", "edge_2", "corner_3", "edge_3"};

struct ClothKeypoints {
  std::string name;                     // of the cloth
  std::array<std::size_t, 8> vertices;  // of its mesh, in the order of KEYPOINT_NAMES
};

// rest: points of the mesh in the cloth's frame [n >= 1, m]
ClothKeypoints cloth_keypoints(const std::string& name, std::span<const Vec3> rest);

struct EnvironmentColumn {
  std::string name;        // without slashes: beaker_x, beaker_qw, towel_corner_0_x
  bool is_length = false;  // [m]; else a number of a unit quaternion
};

// objects: names. -> [n_objects x 7 + n_cloths x 24]
std::vector<EnvironmentColumn> environment_columns(std::span<const std::string> objects,
                                                   std::span<const ClothKeypoints> cloths);

// Of a cloth whose points [n, m] are there now: x, y, z of each keypoint.  -> [24]
std::array<double, 24> keypoint_numbers(const ClothKeypoints& cloth, std::span<const Vec3> points);

}  // namespace pvg
