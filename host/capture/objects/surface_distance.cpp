#include "host/capture/objects/surface_distance.hpp"

#include <algorithm>
#include <cmath>

namespace pvg {

std::vector<double> surface_distances(const TriangleMesh& from, const NearestTriangle& to) {
  Vec3 low = Vec3::Constant(INFINITY), high = -low;
  std::vector<double> distances;
  for (const Vec3& p : from.points) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
    distances.push_back(to.distance(p));
  }
  const double step = (high - low).maxCoeff() / 100;
  for (const Triangle& t : from.triangles) {
    const Vec3 &a = from.points[t[0]], &b = from.points[t[1]], &c = from.points[t[2]];
    distances.push_back(to.distance((a + b + c) / 3));
    const double longest = std::sqrt(std::max({(b - a).squaredNorm(), (c - b).squaredNorm(), (a - c).squaredNorm()}));
    const int n = step > 0 ? int(std::min(std::ceil(longest / step), 200.0)) : 1;
    for (int i = 0; i < n; ++i)
      for (int j = 0; i + j <= n; ++j)
        if (i < n && j < n && i + j > 0)  // no corner
          distances.push_back(to.distance((double(i) * a + double(j) * b + double(n - i - j) * c) / n));
  }
  std::sort(distances.begin(), distances.end());
  return distances;
}

std::vector<double> surface_distances(const TriangleMesh& from, const TriangleMesh& to) {
  return surface_distances(from, NearestTriangle(to));
}

}  // namespace pvg
