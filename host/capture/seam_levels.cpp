#include "host/capture/seam_levels.hpp"

#include <Eigen/IterativeLinearSolvers>
#include <Eigen/SparseCore>
#include <algorithm>
#include <numeric>

namespace pvg {
namespace {

constexpr float SMOOTHNESS = 0.1f, SMALLNESS = 0.001f;
constexpr double TOLERANCE = 1e-4;

// of (g_a - g_b)^2
void add_difference(std::vector<Eigen::Triplet<float>>& entries, int a, int b, float weight) {
  for (const auto& [i, j, sign] : {std::tuple{a, a, 1.0f}, {b, b, 1.0f}, {a, b, -1.0f}, {b, a, -1.0f}})
    entries.emplace_back(i, j, sign * weight);
}

}  // namespace

std::vector<Vec3f> level_seams(std::span<const ChartCorner> corners, std::span<const Triangle> triangles) {
  const int n = int(corners.size());
  std::vector<Eigen::Triplet<float>> entries;
  Eigen::MatrixX3f right = Eigen::MatrixX3f::Zero(n, 3);
  std::vector<int> by_point(corners.size());
  std::iota(by_point.begin(), by_point.end(), 0);
  std::stable_sort(by_point.begin(), by_point.end(),
                   [&](int a, int b) { return corners[std::size_t(a)].point < corners[std::size_t(b)].point; });
  for (std::size_t first = 0, end = 0; first < by_point.size(); first = end) {
    while (end < by_point.size() &&
           corners[std::size_t(by_point[end])].point == corners[std::size_t(by_point[first])].point)
      ++end;
    for (std::size_t i = first; i < end; ++i)
      for (std::size_t j = i + 1; j < end; ++j) {
        const int a = by_point[i], b = by_point[j];
        if (!corners[std::size_t(a)].is_seen || !corners[std::size_t(b)].is_seen) continue;
        const Vec3f step = corners[std::size_t(b)].color - corners[std::size_t(a)].color;
        add_difference(entries, a, b, 1);
        right.row(a) += step.transpose();
        right.row(b) -= step.transpose();
      }
  }
  for (const Triangle& t : triangles)
    for (std::size_t k = 0; k < 3; ++k) add_difference(entries, int(t[k]), int(t[(k + 1) % 3]), SMOOTHNESS);
  for (int i = 0; i < n; ++i) entries.emplace_back(i, i, SMALLNESS);
  Eigen::SparseMatrix<float> A(n, n);
  A.setFromTriplets(entries.begin(), entries.end());
  Eigen::ConjugateGradient<Eigen::SparseMatrix<float>, Eigen::Lower | Eigen::Upper> solver(A);
  solver.setTolerance(float(TOLERANCE));
  const Eigen::MatrixX3f g = solver.solve(right);
  std::vector<Vec3f> out;
  for (int i = 0; i < n; ++i) out.push_back(g.row(i).transpose());
  return out;
}

}  // namespace pvg
