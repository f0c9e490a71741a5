#include "host/identify/channels/embedded_point.hpp"

#include <limits>

namespace pvg::diagnose {

NodeWeights embed(const TetMesh& mesh, const Vec3& point) {
  NodeWeights best;
  double least = -std::numeric_limits<double>::infinity();  // weight; 0 or more: inside
  for (std::size_t e = 0; e < mesh.n_elements(); ++e) {
    const std::uint32_t* node = &mesh.elements[e * std::size_t(mesh.nodes_per_element)];
    Eigen::Matrix3d edges;
    for (int k = 0; k < 3; ++k) edges.col(k) = mesh.points[node[k + 1]] - mesh.points[node[0]];
    const Vec3 w = edges.inverse() * (point - mesh.points[node[0]]);
    const double w0 = 1 - w.sum(), lowest = std::min(w0, w.minCoeff());
    if (!(lowest > least)) continue;
    least = lowest;
    best = {{node[0], w0}, {node[1], w.x()}, {node[2], w.y()}, {node[3], w.z()}};
  }
  return best;
}

NodeWeights embed(const TriangleMesh& mesh, const Vec3& point) {
  NodeWeights best;
  double least = std::numeric_limits<double>::infinity();  // distance [m]
  for (const Triangle& t : mesh.triangles) {
    Eigen::Matrix<double, 3, 2> edges;
    for (int k = 0; k < 2; ++k) edges.col(k) = mesh.points[t[k + 1]] - mesh.points[t[0]];
    const Eigen::Vector2d w = edges.colPivHouseholderQr().solve(point - mesh.points[t[0]]);
    const Eigen::Vector3d all = Eigen::Vector3d(1 - w.sum(), w.x(), w.y()).cwiseMax(0);
    const Eigen::Vector3d share = all / all.sum();
    const Vec3 nearest = share[0] * mesh.points[t[0]] + share[1] * mesh.points[t[1]] + share[2] * mesh.points[t[2]];
    if (!((nearest - point).norm() < least)) continue;
    least = (nearest - point).norm();
    best = {{t[0], share[0]}, {t[1], share[1]}, {t[2], share[2]}};
  }
  return best;
}

}  // namespace pvg::diagnose
