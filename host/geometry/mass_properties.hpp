// Mass, centre and inertia of a closed surface filled evenly, exact for its triangles: the sum over the signed
// tetrahedra from the origin to each triangle of  V = a . (b x c) / 6,  int x = V s / 4,  int x x^T = V (s s^T + a a^T
// + b b^T + c c^T) / 20 with s = a + b + c (Tonon 2004, "Explicit exact formulas for the 3-D tetrahedron inertia
// tensor").
#pragma once
#include "host/geometry/mesh.hpp"

namespace pvg {

struct MassProperties {
  double volume = 0;                                  // [m^3]
  double mass = 0;                                    // [kg]
  Vec3 center = Vec3::Zero();                         // [m]
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();  // about the centre, axes of the mesh's frame [kg m^2]
};

// density [kg/m^3]. The surface must be closed and face outward.
MassProperties mass_properties(const TriangleMesh& surface, double density);

// xx, yy, zz, and where they are not zero xy, xz, yz of a body's inertia about its centre of mass, as scene files have
// them.
std::vector<double> moments_and_products(const Eigen::Matrix3d& inertia);

}  // namespace pvg
