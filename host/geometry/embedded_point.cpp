#include "host/geometry/embedded_point.hpp"

#include <Eigen/QR>
#include <limits>

#include "host/geometry/tet_embedding.hpp"

namespace pvg {

NodeWeights embed(const TetMesh& mesh, const Vec3& point) {
  const SparseRows weights = embed_points(mesh, std::span(&point, 1)).weights;
  NodeWeights nodes;
  for (std::size_t i = 0; i < weights.column.size(); ++i) nodes.push_back({weights.column[i], weights.weight[i]});
  return nodes;
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

}  // namespace pvg
