#include "host/geometry/mesh_checks.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <sstream>

#include "host/base/counted.hpp"
#include "host/base/error.hpp"

namespace pvg {
namespace {

using Key = std::array<std::uint32_t, 2>;

std::string text(const Vec3& p) {
  std::ostringstream s;
  s << "(" << p.x() << ", " << p.y() << ", " << p.z() << ")";
  return s.str();
}

double tetrahedron_volume(const TriangleMesh& mesh, const Triangle& t) {
  return mesh.points[t[0]].dot(mesh.points[t[1]].cross(mesh.points[t[2]])) / 6;
}

// How often each edge (smaller index first) is run through upward and downward.
// In ascending order.
std::vector<std::pair<Key, std::array<int, 2>>> edge_uses(const TriangleMesh& mesh) {
  std::vector<std::pair<Key, int>> edges;  // and whether it is run through downward
  edges.reserve(3 * mesh.triangles.size());
  for (const Triangle& t : mesh.triangles)
    for (int i = 0; i < 3; ++i) {
      const std::uint32_t a = t[i], b = t[(i + 1) % 3];
      edges.push_back({{std::min(a, b), std::max(a, b)}, a < b ? 0 : 1});
    }
  std::sort(edges.begin(), edges.end());
  std::vector<std::pair<Key, std::array<int, 2>>> uses;
  for (const auto& [edge, direction] : edges) {
    if (uses.empty() || uses.back().first != edge) uses.push_back({edge, {0, 0}});
    ++uses.back().second[direction];
  }
  return uses;
}

std::optional<std::string> broken_number(const TriangleMesh& mesh) {
  if (mesh.triangles.empty()) return "has no triangles";
  for (std::size_t i = 0; i < mesh.points.size(); ++i) {
    if (!mesh.points[i].allFinite()) {
      return "vertex " + std::to_string(i) + " is " + text(mesh.points[i]) +
             ", not a finite position: export the mesh again";
    }
  }
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    for (const std::uint32_t corner : mesh.triangles[i]) {
      if (corner >= mesh.points.size()) {
        return "triangle " + std::to_string(i) + " names vertex " + std::to_string(corner) + ", but there are only " +
               std::to_string(mesh.points.size());
      }
    }
  }
  return {};
}

std::optional<std::string> flat_triangle(const TriangleMesh& mesh) {
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const auto& [a, b, c] = mesh.triangles[i];
    const Vec3 u = mesh.points[b] - mesh.points[a], v = mesh.points[c] - mesh.points[a];
    const double longest = std::max({u.squaredNorm(), v.squaredNorm(), (u - v).squaredNorm()});
    // twice the area against the longest edge squared: below 1e-9 the corners lie on one line for all that doubles tell
    if (!(u.cross(v).norm() > 1e-9 * longest)) {
      return "triangle " + std::to_string(i) + " near " + text(mesh.points[a]) +
             " has no area: remove degenerate triangles";
    }
  }
  return {};
}

std::optional<std::string> open_or_flipped(const TriangleMesh& mesh) {
  std::size_t n_open = 0, n_many = 0, n_flipped = 0;
  Key open{}, many{}, flipped{};
  for (const auto& [edge, use] : edge_uses(mesh)) {
    const int total = use[0] + use[1];
    if (total == 1 && n_open++ == 0) open = edge;
    if (total > 2 && use[0] != use[1] && n_many++ == 0) many = edge;
    if (total == 2 && use[0] != use[1] && n_flipped++ == 0) flipped = edge;
  }
  const auto from_to = [&](const Key& e) {
    return "from " + text(mesh.points[e[0]]) + " to " + text(mesh.points[e[1]]);
  };
  if (n_open > 0) {
    return "has holes: " + counted(n_open, "edge belongs", "edges belong") + " to one triangle only, the first " +
           from_to(open) + "; close the surface";
  }
  if (n_flipped > 0) {
    return "has flipped triangles: at " + counted(n_flipped, "edge") +
           " the two neighbours face opposite ways, the first " + from_to(flipped) +
           "; make the orientation consistent";
  }
  if (n_many > 0) {
    return "has " + counted(n_many, "edge") + " with more than two triangles, the first " + from_to(many) +
           "; a solid's surface must not branch";
  }
  return {};
}

struct Component {
  double volume = 0;  // signed [m^3]
  Vec3 low = Vec3::Constant(INFINITY), high = Vec3::Constant(-INFINITY);
};

std::vector<Component> components_of(const TriangleMesh& mesh) {
  const std::vector<int> of = triangle_components(mesh);
  std::vector<Component> components(1 + *std::max_element(of.begin(), of.end()));
  for (std::size_t i = 0; i < of.size(); ++i) {
    Component& c = components[of[i]];
    c.volume += tetrahedron_volume(mesh, mesh.triangles[i]);
    for (const std::uint32_t corner : mesh.triangles[i]) {
      c.low = c.low.cwiseMin(mesh.points[corner]);
      c.high = c.high.cwiseMax(mesh.points[corner]);
    }
  }
  return components;
}

// An inward-facing part is a cavity if another part surrounds it, an inside-out solid otherwise.
std::optional<std::string> inward_part(const TriangleMesh& mesh) {
  const std::vector<Component> components = components_of(mesh);
  for (const Component& c : components) {
    if (c.volume > 0) continue;
    const bool is_cavity = std::any_of(components.begin(), components.end(), [&](const Component& other) {
      return other.volume > -c.volume && (other.low.array() < c.low.array()).all() &&
             (other.high.array() > c.high.array()).all();
    });
    if (is_cavity) continue;
    const std::string which = components.size() == 1 ? "" : " (the part around " + text((c.low + c.high) / 2) + ")";
    return "has its triangles facing inward" + which + ": flip them, counter-clockwise seen from outside";
  }
  return {};
}

}  // namespace

TriangleMesh weld_points(const TriangleMesh& mesh, double tolerance) {
  using Cell = std::array<std::int64_t, 3>;
  std::map<Cell, std::vector<std::uint32_t>> cells;
  std::vector<std::uint32_t> first(mesh.points.size());
  Vec3 low = Vec3::Constant(INFINITY);  // cells are counted from here: no more of them than the size has tolerances
  for (const Vec3& p : mesh.points)
    if (p.allFinite()) low = low.cwiseMin(p);
  for (std::uint32_t i = 0; i < mesh.points.size(); ++i) {
    first[i] = i;
    const Vec3& p = mesh.points[i];
    if (!p.allFinite()) continue;  // left for the check to name
    const Vec3 counted = (p - low) / tolerance;
    const Cell at = {std::llround(counted.x()), std::llround(counted.y()), std::llround(counted.z())};
    for (int k = 0; k < 27 && first[i] == i; ++k) {
      const auto near = cells.find({at[0] + k % 3 - 1, at[1] + k / 3 % 3 - 1, at[2] + k / 9 - 1});
      if (near == cells.end()) continue;
      for (const std::uint32_t j : near->second) {
        if (((mesh.points[j] - p).cwiseAbs().array() <= tolerance).all()) {
          first[i] = j;
          break;
        }
      }
    }
    if (first[i] == i) cells[at].push_back(i);
  }
  TriangleMesh welded;
  std::vector<std::int64_t> renumbered(mesh.points.size(), -1);
  std::vector<char> is_used(mesh.points.size(), 0);
  std::vector<Triangle> kept;
  for (const Triangle& t : mesh.triangles) {
    const Triangle w = {first[t[0]], first[t[1]], first[t[2]]};
    if (w[0] == w[1] || w[1] == w[2] || w[2] == w[0]) continue;
    kept.push_back(w);
    for (const std::uint32_t corner : w) is_used[corner] = 1;
  }
  for (std::size_t i = 0; i < mesh.points.size(); ++i) {
    if (!is_used[i]) continue;
    renumbered[i] = std::int64_t(welded.points.size());
    welded.points.push_back(mesh.points[i]);
  }
  for (Triangle& t : kept) {
    for (std::uint32_t& corner : t) corner = std::uint32_t(renumbered[corner]);
  }
  welded.triangles = std::move(kept);
  return welded;
}

std::optional<std::string> closed_surface_defect(const TriangleMesh& mesh) {
  for (const auto check : {broken_number, flat_triangle, open_or_flipped, inward_part}) {
    if (auto defect = check(mesh)) return defect;
  }
  return {};
}

void check_closed_surface(const TriangleMesh& mesh, const std::string& name) {
  if (const auto defect = closed_surface_defect(mesh)) throw UsageError(name + ": the surface " + *defect + ".");
}

std::vector<int> triangle_components(const TriangleMesh& mesh) {
  std::vector<int> parent(mesh.triangles.size());
  std::iota(parent.begin(), parent.end(), 0);
  const auto root = [&](int i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
  };
  std::vector<std::pair<Key, int>> edges;  // each with a triangle that it belongs to, in order
  edges.reserve(3 * mesh.triangles.size());
  for (int i = 0; i < int(mesh.triangles.size()); ++i)
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t a = mesh.triangles[i][k], b = mesh.triangles[i][(k + 1) % 3];
      edges.push_back({{std::min(a, b), std::max(a, b)}, i});
    }
  std::sort(edges.begin(), edges.end());
  for (std::size_t e = 1; e < edges.size(); ++e)
    if (edges[e].first == edges[e - 1].first) parent[root(edges[e].second)] = root(edges[e - 1].second);
  std::vector<int> number(mesh.triangles.size(), -1), component(mesh.triangles.size());
  int n = 0;
  for (int i = 0; i < int(component.size()); ++i) {
    int& of_root = number[root(i)];
    if (of_root < 0) of_root = n++;
    component[i] = of_root;
  }
  return component;
}

double enclosed_volume(const TriangleMesh& mesh) {
  double volume = 0;
  for (const Triangle& t : mesh.triangles) volume += tetrahedron_volume(mesh, t);
  return volume;
}

}  // namespace pvg
