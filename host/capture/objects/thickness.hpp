// How thick the walls of a closed surface are. Pure.
#pragma once
#include "host/geometry/mesh.hpp"

namespace pvg {

struct WallThickness {
  double thickness = 0;  // from the middle of a triangle straight in to where the surface is met again [m]
  double area = 0;       // that it stands for [m^2]
  Vec3 place = Vec3::Zero();
};

// Ascending; of at most 2000 triangles, evenly chosen.
std::vector<WallThickness> wall_thickness(const TriangleMesh& mesh);

// Share of the area whose wall is thinner.
double share_thinner(const std::vector<WallThickness>& walls, double than);

}  // namespace pvg
