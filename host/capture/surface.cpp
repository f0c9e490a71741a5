#include "host/capture/surface.hpp"

#include <meshoptimizer.h>

#include <algorithm>
#include <numeric>

namespace pvg {
namespace {

// union and find with halved paths
struct Parts {
  std::vector<std::uint32_t> above;
  explicit Parts(std::size_t n) : above(n) { std::iota(above.begin(), above.end(), 0u); }
  std::uint32_t find(std::uint32_t i) {
    while (above[i] != i) i = above[i] = above[above[i]];
    return i;
  }
  void join(std::uint32_t a, std::uint32_t b) {
    a = find(a);
    b = find(b);
    above[std::max(a, b)] = std::min(a, b);
  }
};

double area_of(const std::vector<Vec3f>& points, const Triangle& t) {
  const Vec3 a = points[t[0]].cast<double>();
  return 0.5 * (points[t[1]].cast<double>() - a).cross(points[t[2]].cast<double>() - a).norm();
}

}  // namespace

double surface_area(const std::vector<Vec3f>& points, const std::vector<Triangle>& triangles) {
  double area = 0;
  for (const Triangle& t : triangles) area += area_of(points, t);
  return area;
}

FusedSurface without_unused(const FusedSurface& surface) {
  constexpr std::uint32_t NONE = 0xffffffffu;
  FusedSurface out;
  std::vector<std::uint32_t> number(surface.points.size(), NONE);
  for (const Triangle& t : surface.triangles) {
    if (!(area_of(surface.points, t) > 0)) continue;
    Triangle kept;
    for (int k = 0; k < 3; ++k) {
      std::uint32_t& n = number[t[k]];
      if (n == NONE) {
        n = std::uint32_t(out.points.size());
        out.points.push_back(surface.points[t[k]]);
        out.sureness.push_back(surface.sureness[t[k]]);
      }
      kept[k] = n;
    }
    out.triangles.push_back(kept);
  }
  return out;
}

std::vector<bool> in_large_pieces(const std::vector<Vec3f>& points, const std::vector<Triangle>& triangles,
                                  double least_area) {
  Parts parts(points.size());
  for (const Triangle& t : triangles) {
    parts.join(t[0], t[1]);
    parts.join(t[0], t[2]);
  }
  std::vector<double> area(points.size(), 0.0);
  for (const Triangle& t : triangles) area[parts.find(t[0])] += area_of(points, t);
  std::vector<bool> out;
  for (const Triangle& t : triangles) out.push_back(area[parts.find(t[0])] >= least_area);
  return out;
}

FusedSurface without_small_pieces(const FusedSurface& surface, double least_area) {
  const std::vector<bool> stays = in_large_pieces(surface.points, surface.triangles, least_area);
  FusedSurface kept{surface.points, surface.sureness, {}};
  for (std::size_t i = 0; i < stays.size(); ++i)
    if (stays[i]) kept.triangles.push_back(surface.triangles[i]);
  return without_unused(kept);
}

EdgeCounts count_edges(const std::vector<Triangle>& triangles) {
  std::vector<std::array<std::uint32_t, 2>> edges;
  edges.reserve(3 * triangles.size());
  for (const Triangle& t : triangles)
    for (int k = 0; k < 3; ++k) edges.push_back({std::min(t[k], t[(k + 1) % 3]), std::max(t[k], t[(k + 1) % 3])});
  std::sort(edges.begin(), edges.end());
  EdgeCounts out;
  for (std::size_t i = 0; i < edges.size();) {
    std::size_t j = i;
    while (j < edges.size() && edges[j] == edges[i]) ++j;
    out.boundary += j - i == 1;
    out.crowded += j - i > 2;
    i = j;
  }
  return out;
}

std::vector<Vec3f> point_normals(const std::vector<Vec3f>& points, const std::vector<Triangle>& triangles) {
  std::vector<Vec3f> normals(points.size(), Vec3f::Zero());
  for (const Triangle& t : triangles) {
    const Vec3f n = (points[t[1]] - points[t[0]]).cross(points[t[2]] - points[t[0]]);
    for (const std::uint32_t corner : t) normals[corner] += n;
  }
  for (Vec3f& n : normals) n = n.squaredNorm() > 0 ? Vec3f(n.normalized()) : Vec3f(0, 0, 1);
  return normals;
}

VisualMesh simplified(const VisualMesh& mesh, std::size_t n_triangles, double error) {
  std::vector<unsigned> indices;
  for (const Triangle& t : mesh.triangles) indices.insert(indices.end(), t.begin(), t.end());
  const float scale = meshopt_simplifyScale(&mesh.points[0].x(), mesh.points.size(), sizeof(Vec3f));
  std::vector<unsigned> fewer(indices.size());
  const std::size_t n =
      meshopt_simplify(fewer.data(), indices.data(), indices.size(), &mesh.points[0].x(), mesh.points.size(),
                       sizeof(Vec3f), 3 * n_triangles, float(error) / scale, 0, nullptr);
  VisualMesh out;
  std::vector<std::uint32_t> number(mesh.points.size(), 0);  // 1 + of the new mesh
  for (std::size_t i = 0; i + 2 < n; i += 3) {
    Triangle t;
    for (std::size_t k = 0; k < 3; ++k) {
      const unsigned old = fewer[i + k];
      if (number[old] == 0) {
        out.points.push_back(mesh.points[old]);
        if (!mesh.normals.empty()) out.normals.push_back(mesh.normals[old]);
        if (!mesh.uvs.empty()) out.uvs.push_back(mesh.uvs[old]);
        if (!mesh.colors.empty()) out.colors.push_back(mesh.colors[old]);
        number[old] = std::uint32_t(out.points.size());
      }
      t[k] = number[old] - 1;
    }
    out.triangles.push_back(t);
  }
  return out;
}

}  // namespace pvg
