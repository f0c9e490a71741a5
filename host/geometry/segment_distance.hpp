// Distances on the host, by trying every kind of closest pair: for set-up and checks, not for the solver.
#pragma once
#include "host/geometry/mesh.hpp"

namespace pvg {

double point_segment_distance(const Vec3& p, const Vec3& a, const Vec3& b);
double point_triangle_distance(const Vec3& p, const Vec3& t0, const Vec3& t1, const Vec3& t2);
double edge_edge_distance(const Vec3& a0, const Vec3& a1, const Vec3& b0, const Vec3& b1);

}  // namespace pvg
