// The map of a tetrahedron with 4 or 10 nodes, written apart from the kernels: no shape gradient stands here.
#pragma once
#include <Eigen/Core>

#include "tests/physics/energies/energy_check.hpp"

namespace pvg::tetrahedron_check {

constexpr int EDGES[6][2] = {{0, 1}, {1, 2}, {0, 2}, {0, 3}, {1, 3}, {2, 3}};

// position of the reference point r of an element with 4 or 10 nodes
inline Vec3 position(int n_nodes, const Vec3* x, const Vec3& r) {
  const double L[4] = {1 - r.sum(), r(0), r(1), r(2)};
  Vec3 sum = Vec3::Zero();
  for (int a = 0; a < 4; ++a) sum += L[a] * (n_nodes == 4 ? 1 : 2 * L[a] - 1) * x[a];
  for (int e = 0; e < n_nodes - 4; ++e) sum += 4 * L[EDGES[e][0]] * L[EDGES[e][1]] * x[4 + e];
  return sum;
}

inline Vec3 quadrature_point(int q) {
  Vec3 r = Vec3::Constant((5 - std::sqrt(5.0)) / 20);
  if (q > 0) r(q - 1) = (5 + 3 * std::sqrt(5.0)) / 20;
  return r;
}

// dx/dX; dx/dr by differences, which are exact for a quadratic map
template <class Params>
Eigen::Matrix3d deformation(const Params& p, const Vec3* x, const Vec3& r) {
  constexpr int n_nodes = sizeof(p.site) / sizeof(u32);
  Eigen::Matrix3d Ds;
  for (int i = 0; i < 3; ++i)
    Ds.col(i) = position(n_nodes, x, r + 0.5 * Vec3::Unit(i)) - position(n_nodes, x, r - 0.5 * Vec3::Unit(i));
  return Ds * Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(p.rest_inverse);
}

}  // namespace pvg::tetrahedron_check
