// The dihedral angle at an edge is pi less the angle of the outward normals of the two faces beside it. The centre c of
// the circumsphere of (0, u, v, w) is (|u|^2 v x w + |v|^2 w x u + |w|^2 u x v) / (2 u . (v x w)).
#include "host/geometry/tet_quality.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace pvg {

TetQuality tet_quality(const TetMesh& mesh) {
  TetQuality out;
  out.least_dihedral = std::numbers::pi;
  for (std::size_t e = 0; e < mesh.n_elements(); ++e) {
    const std::uint32_t* corner = &mesh.elements[e * std::size_t(mesh.nodes_per_element)];
    Vec3 p[4], normal[4];  // normal[k]: of the face across from corner k
    for (int k = 0; k < 4; ++k) p[k] = mesh.points[corner[k]];
    for (int k = 0; k < 4; ++k) {
      const Vec3 &a = p[(k + 1) % 4], &b = p[(k + 2) % 4], &c = p[(k + 3) % 4];
      normal[k] = (b - a).cross(c - a).normalized();
      if (normal[k].dot(p[k] - a) > 0) normal[k] *= -1;
    }
    double least = std::numbers::pi;
    for (int k = 0; k < 4; ++k)
      for (int m = k + 1; m < 4; ++m)
        least =
            std::min(least, std::numbers::pi - std::atan2(normal[k].cross(normal[m]).norm(), normal[k].dot(normal[m])));
    double shortest = INFINITY;
    for (int k = 0; k < 4; ++k)
      for (int m = k + 1; m < 4; ++m) shortest = std::min(shortest, (p[k] - p[m]).norm());
    const Vec3 u = p[1] - p[0], v = p[2] - p[0], w = p[3] - p[0];
    const Vec3 center = (u.squaredNorm() * v.cross(w) + v.squaredNorm() * w.cross(u) + w.squaredNorm() * u.cross(v)) /
                        (2 * u.dot(v.cross(w)));
    out.least_dihedral = std::min(out.least_dihedral, least);
    out.largest_radius_edge = std::max(out.largest_radius_edge, center.norm() / shortest);
    out.n_slivers += least < SLIVER;
  }
  return out;
}

}  // namespace pvg
