#include "host/geometry/primitive_shapes.hpp"

#include <cmath>
#include <map>
#include <numbers>
#include <utility>

#include "host/base/error.hpp"
#include "host/geometry/mass_properties.hpp"
#include "host/geometry/tet_mesh.hpp"

namespace pvg {
namespace {

using Index = std::uint32_t;

// Cells of a grid with nodes counted along the first axis first, six tetrahedra each: one for each order of walking
// along the three axes from the cell's lowest corner to its highest.
std::vector<Index> kuhn_elements(const std::array<int, 3>& n) {
  const Index strides[3] = {1, Index(n[0] + 1), Index(n[0] + 1) * Index(n[1] + 1)};
  const int orders[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}};
  std::vector<Index> elements;
  for (int k = 0; k < n[2]; ++k)
    for (int j = 0; j < n[1]; ++j)
      for (int i = 0; i < n[0]; ++i)
        for (int order = 0; order < 6; ++order) {
          Index corner[4] = {Index(i) + strides[1] * Index(j) + strides[2] * Index(k)};
          for (int step = 0; step < 3; ++step) corner[step + 1] = corner[step] + strides[orders[order][step]];
          if (order >= 3) std::swap(corner[2], corner[3]);  // odd permutations are mirrored
          elements.insert(elements.end(), corner, corner + 4);
        }
  return elements;
}

TetMesh finished(TetMesh mesh, int nodes_per_element) {
  mesh.nodes_per_element = 4;
  mesh.surface = boundary_triangles(mesh);
  return nodes_per_element == 10 ? make_quadratic(mesh) : mesh;
}

// Facets with corners on a sphere lie below it, a triangle with edges a, b, c by (a^2 + b^2 + c^2) / (24 R) on the
// mean. Moves each point of the sphere out by the mean of this around it: then the facets lie on the sphere on the
// mean.
void raise_facets(TetMesh& mesh, double radius) {
  const auto is_on_sphere = [&](Index i) { return std::abs(mesh.points[i].norm() - radius) < 1e-9 * radius; };
  std::vector<double> depth(mesh.points.size(), 0), area(mesh.points.size(), 0);
  for (const auto& [i, j, k] : boundary_triangles(mesh)) {
    if (!is_on_sphere(i) || !is_on_sphere(j) || !is_on_sphere(k)) continue;
    const Vec3 a = mesh.points[j] - mesh.points[i], b = mesh.points[k] - mesh.points[j], c = -a - b;
    const double weight = a.cross(b).norm();
    for (const Index corner : {i, j, k}) {
      depth[corner] += weight * (a.squaredNorm() + b.squaredNorm() + c.squaredNorm()) / (24 * radius);
      area[corner] += weight;
    }
  }
  for (std::size_t i = 0; i < area.size(); ++i)
    if (area[i] > 0) mesh.points[i] *= 1 + depth[i] / (area[i] * radius);
}

// without the points that no triangle names
TriangleMesh compact(const std::vector<Vec3>& points, const std::vector<Triangle>& triangles) {
  TriangleMesh mesh;
  std::vector<int> new_index(points.size(), -1);
  for (Triangle triangle : triangles) {
    for (Index& corner : triangle) {
      if (new_index[corner] < 0) {
        new_index[corner] = int(mesh.points.size());
        mesh.points.push_back(points[corner]);
      }
      corner = Index(new_index[corner]);
    }
    mesh.triangles.push_back(triangle);
  }
  return mesh;
}

// every triangle into four by the midpoints of its edges, moved out to the sphere
void subdivide_sphere(TriangleMesh& mesh, double radius) {
  std::map<std::pair<Index, Index>, Index> middle_of;
  const auto middle = [&](Index a, Index b) {
    const auto [at, is_new] = middle_of.try_emplace(std::minmax(a, b), Index(mesh.points.size()));
    if (is_new) mesh.points.push_back(radius * (mesh.points[a] + mesh.points[b]).normalized());
    return at->second;
  };
  std::vector<Triangle> finer;
  for (const auto& [a, b, c] : mesh.triangles) {
    const Index ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
    finer.insert(finer.end(), {{a, ab, ca}, {b, bc, ab}, {c, ca, bc}, {ab, bc, ca}});
  }
  mesh.triangles = std::move(finer);
}

}  // namespace

TriangleMesh box_surface(const Vec3& size, const std::array<int, 3>& divisions) {
  const TetMesh solid = box_solid(size, divisions, 4);
  return compact(solid.points, solid.surface);
}

TriangleMesh sphere_surface(double radius, int subdivisions) {
  // the corners of three rectangles with sides in the golden ratio
  const double g = std::numbers::phi;
  TriangleMesh mesh;
  mesh.points = {{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                 {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
  for (Vec3& point : mesh.points) point = radius * point.normalized();
  mesh.triangles = {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                    {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                    {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
  for (int i = 0; i < subdivisions; ++i) subdivide_sphere(mesh, radius);
  return mesh;
}

TriangleMesh cylinder_surface(double radius, double length, int sides) {
  TriangleMesh mesh;
  const Index n = Index(sides), lower_centre = 2 * n, upper_centre = 2 * n + 1;
  for (const double z : {-length / 2, length / 2})
    for (Index i = 0; i < n; ++i) {
      const double angle = 2 * std::numbers::pi * i / sides;
      mesh.points.emplace_back(radius * std::cos(angle), radius * std::sin(angle), z);
    }
  mesh.points.emplace_back(0, 0, -length / 2);
  mesh.points.emplace_back(0, 0, length / 2);
  for (Index i = 0; i < n; ++i) {
    const Index j = (i + 1) % n;
    mesh.triangles.push_back({i, j, n + j});
    mesh.triangles.push_back({i, n + j, n + i});
    mesh.triangles.push_back({lower_centre, j, i});
    mesh.triangles.push_back({upper_centre, n + i, n + j});
  }
  return mesh;
}

TriangleMesh capsule_surface(double radius, double length, int sides) {
  TriangleMesh mesh;
  const int n_rings = 2 * std::max(1, sides / 4);  // half of them on each half ball, from the lower pole up
  const Index n = Index(sides);
  mesh.points.emplace_back(0, 0, -length / 2 - radius);
  for (int ring = 0; ring < n_rings; ++ring) {
    const bool is_upper = ring >= n_rings / 2;
    const double latitude = std::numbers::pi * (ring + (is_upper ? 0 : 1) - n_rings / 2) / n_rings;
    for (int i = 0; i < sides; ++i) {
      const double angle = 2 * std::numbers::pi * i / sides;
      mesh.points.emplace_back(radius * std::cos(latitude) * std::cos(angle),
                               radius * std::cos(latitude) * std::sin(angle),
                               (is_upper ? length : -length) / 2 + radius * std::sin(latitude));
    }
  }
  mesh.points.emplace_back(0, 0, length / 2 + radius);
  const Index upper_pole = Index(mesh.points.size()) - 1, last_ring = upper_pole - n;
  for (Index i = 0; i < n; ++i) {
    const Index j = (i + 1) % n;
    mesh.triangles.push_back({0, 1 + j, 1 + i});
    for (Index ring = 1; ring < last_ring; ring += n) {
      mesh.triangles.push_back({ring + i, ring + j, ring + n + j});
      mesh.triangles.push_back({ring + i, ring + n + j, ring + n + i});
    }
    mesh.triangles.push_back({upper_pole, last_ring + i, last_ring + j});
  }
  return mesh;
}

TriangleMesh hexahedron_surface(const std::array<Vec3, 8>& corners) {
  TriangleMesh mesh;
  mesh.points.assign(corners.begin(), corners.end());
  const Index quads[6][4] = {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}};
  for (const auto& quad : quads) {
    mesh.triangles.push_back({quad[0], quad[1], quad[2]});
    mesh.triangles.push_back({quad[0], quad[2], quad[3]});
  }
  if (!(mass_properties(mesh, 1).volume > 0))
    throw UsageError("a hexahedron is flat or inside out: four corners counter-clockwise, then the four above them");
  return mesh;
}

TriangleMesh square_surface(double size) {
  const double half = size / 2;
  return {{{-half, -half, 0}, {half, -half, 0}, {half, half, 0}, {-half, half, 0}}, {{0, 1, 2}, {0, 2, 3}}};
}

TriangleMesh sheet_surface(const std::array<double, 2>& size, const std::array<int, 2>& n) {
  TriangleMesh mesh;
  for (int j = 0; j <= n[1]; ++j)
    for (int i = 0; i <= n[0]; ++i)
      mesh.points.emplace_back(size[0] * (double(i) / n[0] - 0.5), size[1] * (double(j) / n[1] - 0.5), 0);
  const Index row = Index(n[0] + 1);
  for (Index j = 0; j < Index(n[1]); ++j)
    for (Index i = 0; i < Index(n[0]); ++i) {
      const Index a = i + row * j;
      mesh.triangles.push_back({a, a + 1, a + 1 + row});
      mesh.triangles.push_back({a, a + 1 + row, a + row});
    }
  return mesh;
}

TriangleMesh disc_surface(double radius, int rings) {
  TriangleMesh mesh{{Vec3::Zero()}, {}};
  const auto point = [](int ring, int i) {
    return ring == 0 ? Index(0) : Index(3 * ring * (ring - 1) + 1 + i % (6 * ring));
  };
  for (int ring = 1; ring <= rings; ++ring)
    for (int i = 0; i < 6 * ring; ++i) {
      const double angle = 2 * std::numbers::pi * i / (6 * ring), r = radius * ring / rings;
      mesh.points.emplace_back(r * std::cos(angle), r * std::sin(angle), 0);
    }
  // each sextant is a row of triangles between two circles
  for (int ring = 1; ring <= rings; ++ring)
    for (int sextant = 0; sextant < 6; ++sextant)
      for (int i = 0; i < ring; ++i) {
        const int outer = sextant * ring + i, inner = sextant * (ring - 1) + i;
        mesh.triangles.push_back({point(ring - 1, inner), point(ring, outer), point(ring, outer + 1)});
        if (i + 1 < ring)
          mesh.triangles.push_back({point(ring - 1, inner), point(ring, outer + 1), point(ring - 1, inner + 1)});
      }
  return mesh;
}

TetMesh box_solid(const Vec3& size, const std::array<int, 3>& n, int nodes_per_element) {
  TetMesh mesh;
  for (int k = 0; k <= n[2]; ++k)
    for (int j = 0; j <= n[1]; ++j)
      for (int i = 0; i <= n[0]; ++i)
        mesh.points.push_back(
            size.cwiseProduct(Vec3(double(i) / n[0] - 0.5, double(j) / n[1] - 0.5, double(k) / n[2] - 0.5)));
  mesh.elements = kuhn_elements(n);
  return finished(std::move(mesh), nodes_per_element);
}

TetMesh ball_octant_solid(double radius, int n, double grading, int nodes_per_element) {
  TetMesh mesh;
  // a power law takes cells from the far side and crowds them where the graded coordinate starts (side) or ends (z)
  const auto side = [&](int i) { return std::pow(double(i) / n, grading); };
  const auto up = [&](int i) { return 1 - std::pow(1 - double(i) / n, grading); };
  for (int k = 0; k <= n; ++k)
    for (int j = 0; j <= n; ++j)
      for (int i = 0; i <= n; ++i) {
        const Vec3 cube(side(i), side(j), up(k));
        const double largest = cube.maxCoeff();
        // directions turn evenly with the cube's coordinates, tan as on an equiangular cube map
        const Vec3 q = largest > 0 ? Vec3(cube / largest) : cube;
        const Vec3 direction = (q * (std::numbers::pi / 4)).array().tan().matrix();
        mesh.points.push_back(largest > 0 ? Vec3(radius * largest * direction.normalized()) : Vec3::Zero().eval());
      }
  mesh.elements = kuhn_elements({n, n, n});
  mesh.nodes_per_element = 4;
  raise_facets(mesh, radius);
  return finished(std::move(mesh), nodes_per_element);
}

}  // namespace pvg
