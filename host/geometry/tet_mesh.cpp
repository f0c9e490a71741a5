#include "host/geometry/tet_mesh.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>

namespace pvg {
namespace {

// corners of each face, counter-clockwise seen from outside, and the local numbers of the midpoints of its edges 01 12
// 20
struct Face {
  std::array<int, 3> corner, middle;
};
constexpr Face FACES[4] = {
    {{0, 2, 1}, {6, 5, 4}}, {{0, 1, 3}, {4, 8, 7}}, {{1, 2, 3}, {5, 9, 8}}, {{0, 3, 2}, {7, 9, 6}}};
constexpr int EDGES[6][2] = {{0, 1}, {1, 2}, {0, 2}, {0, 3}, {1, 3}, {2, 3}};

}  // namespace

std::vector<Triangle> boundary_triangles(const TetMesh& mesh) {
  std::map<Triangle, int> uses;
  const auto key = [&](const std::uint32_t* element, const Face& face) {
    Triangle t = {element[face.corner[0]], element[face.corner[1]], element[face.corner[2]]};
    std::sort(t.begin(), t.end());
    return t;
  };
  for (std::size_t e = 0; e < mesh.n_elements(); ++e) {
    for (const Face& face : FACES) ++uses[key(&mesh.elements[e * mesh.nodes_per_element], face)];
  }
  std::vector<Triangle> triangles;
  for (std::size_t e = 0; e < mesh.n_elements(); ++e) {
    const std::uint32_t* element = &mesh.elements[e * mesh.nodes_per_element];
    for (const Face& face : FACES) {
      if (uses[key(element, face)] != 1) continue;
      const auto [a, b, c] = face.corner;
      if (mesh.nodes_per_element == 4) {
        triangles.push_back({element[a], element[b], element[c]});
        continue;
      }
      const auto [ab, bc, ca] = face.middle;
      triangles.push_back({element[a], element[ab], element[ca]});
      triangles.push_back({element[ab], element[b], element[bc]});
      triangles.push_back({element[ca], element[bc], element[c]});
      triangles.push_back({element[ab], element[bc], element[ca]});
    }
  }
  return triangles;
}

TetMesh make_quadratic(const TetMesh& linear) {
  TetMesh mesh;
  mesh.nodes_per_element = 10;
  mesh.points = linear.points;
  std::map<Edge, std::uint32_t> middle;
  for (std::size_t e = 0; e < linear.n_elements(); ++e) {
    const std::uint32_t* element = &linear.elements[e * 4];
    mesh.elements.insert(mesh.elements.end(), element, element + 4);
    for (const auto& [i, j] : EDGES) {
      const std::uint32_t a = std::min(element[i], element[j]), b = std::max(element[i], element[j]);
      const auto [at, is_new] = middle.insert({{a, b}, std::uint32_t(mesh.points.size())});
      if (is_new) mesh.points.push_back((linear.points[a] + linear.points[b]) / 2);
      mesh.elements.push_back(at->second);
    }
  }
  mesh.surface = boundary_triangles(mesh);
  return mesh;
}

namespace {

// local numbers of the ten nodes: the four corners' tetrahedra, then the octahedron cut along 4-9, 5-7 or 6-8
constexpr int CORNER_CUTS[4][4] = {{0, 4, 6, 7}, {4, 1, 5, 8}, {6, 5, 2, 9}, {7, 8, 9, 3}};
constexpr int MIDDLE_CUTS[3][4][4] = {{{4, 9, 5, 6}, {4, 9, 6, 7}, {4, 9, 7, 8}, {4, 9, 8, 5}},
                                      {{5, 7, 4, 6}, {5, 7, 6, 9}, {5, 7, 9, 8}, {5, 7, 8, 4}},
                                      {{6, 8, 4, 5}, {6, 8, 5, 9}, {6, 8, 9, 7}, {6, 8, 7, 4}}};

}  // namespace

TetMesh straight_pieces(const TetMesh& whole) {
  if (whole.nodes_per_element == 4) return whole;
  TetMesh mesh;
  mesh.nodes_per_element = 4;
  mesh.points = whole.points;
  for (std::size_t e = 0; e < whole.n_elements(); ++e) {
    const std::uint32_t* n = &whole.elements[e * 10];
    const auto add = [&](const int(&cut)[4]) {
      std::array<std::uint32_t, 4> t = {n[cut[0]], n[cut[1]], n[cut[2]], n[cut[3]]};
      const Vec3& o = mesh.points[t[0]];
      const bool is_upright = (mesh.points[t[1]] - o).cross(mesh.points[t[2]] - o).dot(mesh.points[t[3]] - o) > 0;
      if (!is_upright) std::swap(t[2], t[3]);
      mesh.elements.insert(mesh.elements.end(), t.begin(), t.end());
    };
    for (const auto& cut : CORNER_CUTS) add(cut);
    int shortest = 0;
    double length = INFINITY;
    for (int k = 0; k < 3; ++k) {
      const double diagonal = (mesh.points[n[MIDDLE_CUTS[k][0][0]]] - mesh.points[n[MIDDLE_CUTS[k][0][1]]]).norm();
      if (diagonal < length) {
        length = diagonal;
        shortest = k;
      }
    }
    for (const auto& cut : MIDDLE_CUTS[shortest]) add(cut);
  }
  mesh.surface = whole.surface;
  return mesh;
}

TetMesh refine(const TetMesh& linear) {
  TetMesh mesh = straight_pieces(make_quadratic(linear));
  mesh.surface = boundary_triangles(mesh);
  return mesh;
}

std::vector<double> element_volumes(const TetMesh& mesh) {
  std::vector<double> volumes(mesh.n_elements());
  for (std::size_t e = 0; e < volumes.size(); ++e) {
    const std::uint32_t* n = &mesh.elements[e * mesh.nodes_per_element];
    const Vec3& o = mesh.points[n[0]];
    volumes[e] = (mesh.points[n[1]] - o).cross(mesh.points[n[2]] - o).dot(mesh.points[n[3]] - o) / 6;
  }
  return volumes;
}

std::vector<double> node_masses(const TetMesh& mesh, double density) {
  std::vector<double> masses(mesh.points.size(), 0);
  const std::vector<double> volumes = element_volumes(mesh);
  const int n = mesh.nodes_per_element;
  for (std::size_t e = 0; e < volumes.size(); ++e)
    for (int k = 0; k < n; ++k) {
      const double share = n == 4 ? 1.0 / 4 : k < 4 ? 1.0 / 36 : 4.0 / 27;
      masses[mesh.elements[e * n + k]] += share * density * volumes[e];
    }
  return masses;
}

}  // namespace pvg
