// Large planes of a surface, such as a table and the floor: found by a seeded random search, refined by least squares,
// each with the rectangle that it covers and how sure it is. Pure.
#pragma once
#include <cstdint>
#include <vector>

#include "host/geometry/mesh.hpp"

namespace pvg {

struct PlaneSettings {
  double distance = 0.01;   // of points to the plane [m]
  double angle = 0.35;      // between normals [rad]
  double least_area = 0.1;  // [m^2]
  int most = 8;             // planes
  std::uint64_t seed = 0;
};

// The frame of the plane: x and y along the sides of the smallest rectangle around it, z away from the solid.
struct CapturedPlane {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();  // centre of the rectangle, plane to the mesh's frame
  double width = 0, height = 0;                            // along x and y [m]
  double area = 0;                                         // of the surface on it [m^2]
  double roughness = 0;                                    // root of the mean square distance of the surface [m]
  double height_sigma = 0;                                 // standard deviation of its place along z [m]: see below
  double tilt_sigma = 0;                                   // of its direction [rad]
};

// Largest first. Uncertainty: the surface's distances are errors that neighbours share, so that the plane is as good as
// area / (correlation_length^2) independent points [m] make it.
std::vector<CapturedPlane> find_planes(const std::vector<Vec3f>& points, const std::vector<Triangle>& triangles,
                                       const PlaneSettings& settings, double correlation_length = 0.05);

}  // namespace pvg
