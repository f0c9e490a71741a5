#include "host/render/motion.hpp"

#include <Eigen/Geometry>
#include <Eigen/SVD>

namespace pvg {
namespace {

// x = Q S X + p: the rotation nearest to A, and what is left of it
Eigen::Matrix3d rotation_of(const Eigen::Matrix3d& A) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(A, Eigen::ComputeFullU | Eigen::ComputeFullV);
  return svd.matrixU() * svd.matrixV().transpose();
}

AffineMap between(const AffineMap& a, const AffineMap& b, double share) {
  const Eigen::Matrix3d Qa = rotation_of(a.leftCols<3>()), Qb = rotation_of(b.leftCols<3>());
  const Eigen::Matrix3d Sa = Qa.transpose() * a.leftCols<3>(), Sb = Qb.transpose() * b.leftCols<3>();
  const Eigen::Matrix3d Q = Eigen::Quaterniond(Qa).slerp(share, Eigen::Quaterniond(Qb)).toRotationMatrix();
  AffineMap map;
  map.leftCols<3>() = Q * ((1 - share) * Sa + share * Sb);
  map.col(3) = (1 - share) * a.col(3) + share * b.col(3);
  return map;
}

std::vector<std::vector<Vec3>> between(const std::vector<std::vector<Vec3>>& a, const std::vector<std::vector<Vec3>>& b,
                                       double share) {
  std::vector<std::vector<Vec3>> points = a;
  for (std::size_t i = 0; i < a.size(); ++i)
    for (std::size_t k = 0; k < a[i].size(); ++k) points[i][k] = (1 - share) * a[i][k] + share * b[i][k];
  return points;
}

constexpr double LEAST_SHARE = 1e-9;  // a time that is a step's but for rounding

}  // namespace

SceneState interpolate(const SceneState& a, const SceneState& b, double share) {
  if (share < LEAST_SHARE) return a;
  if (share >= 1) return b;
  SceneState state;
  state.time = (1 - share) * a.time + share * b.time;
  for (std::size_t i = 0; i < a.rigid.size(); ++i) state.rigid.push_back(between(a.rigid[i], b.rigid[i], share));
  state.soft = between(a.soft, b.soft, share);
  state.cloth = between(a.cloth, b.cloth, share);
  for (std::size_t i = 0; i < a.reading.size(); ++i)
    state.reading.push_back((1 - share) * a.reading[i] + share * b.reading[i]);
  return state;
}

SceneState state_at(std::span<const SceneState> states, double time) {
  std::size_t after = 0;
  while (after < states.size() && states[after].time <= time) ++after;
  if (after == 0) return states.front();
  if (after == states.size()) return states.back();
  const SceneState &a = states[after - 1], &b = states[after];
  return interpolate(a, b, (time - a.time) / (b.time - a.time));
}

}  // namespace pvg
