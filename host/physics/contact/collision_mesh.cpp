#include "host/physics/contact/collision_mesh.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <stdexcept>
#include <string>

#include "host/geometry/exact_intersection.hpp"
#include "host/geometry/inside.hpp"
#include "host/geometry/segment_distance.hpp"

namespace pvg {
namespace {

constexpr double FLAT = 1e-6;  // largest angle between two triangles of one plane [rad]

double triangle_area(std::span<const Vec3> rest, const Triangle& t) {
  return 0.5 * (rest[t[1]] - rest[t[0]]).cross(rest[t[2]] - rest[t[0]]).norm();
}

// unit, in the plane of an edge and a corner: from the edge to the corner
Vec3 away_from_edge(std::span<const Vec3> rest, const Edge& edge, std::uint32_t corner) {
  const Vec3 along = (rest[edge[1]] - rest[edge[0]]).normalized(), to_corner = rest[corner] - rest[edge[0]];
  return (to_corner - to_corner.dot(along) * along).normalized();
}

using BodyKey = std::array<u32, 2>;
BodyKey ordered(u32 a, u32 b) { return {std::min(a, b), std::max(a, b)}; }

template <class Primitive>
std::vector<u32> of_body(const std::vector<Primitive>& primitives, u32 body) {
  std::vector<u32> found;
  for (u32 i = 0; i < primitives.size(); ++i)
    if (primitives[i].body == body) found.push_back(i);
  return found;
}

template <class Primitive>
void check_primitives(const CollisionMesh& mesh, const std::vector<Primitive>& primitives, std::size_t n_sites,
                      const std::string& what) {
  u32 world = 0;
  for (const Primitive& primitive : primitives) {
    if (primitive.body >= mesh.bodies.size())
      throw std::logic_error("collision " + what + " names body " + std::to_string(primitive.body) + " of " +
                             std::to_string(mesh.bodies.size()));
    if (mesh.bodies[primitive.body].world < world)
      throw std::logic_error("collision " + what + "s are not sorted by world");
    world = mesh.bodies[primitive.body].world;
    if constexpr (std::is_same_v<Primitive, CollisionPoint>) {
      if (primitive.site >= n_sites) throw std::logic_error("collision " + what + " lies outside the sites");
    } else {
      for (const u32 site : primitive.site)
        if (site >= n_sites) throw std::logic_error("collision " + what + " lies outside the sites");
    }
  }
}

}  // namespace

void add_surface(CollisionMesh& mesh, u32 body, std::span<const u32> site, std::span<const Vec3> rest,
                 std::span<const Triangle> triangles) {
  std::vector<double> point_area(site.size(), 0);
  struct Side {
    double area = 0;
    std::vector<Vec3> away;  // from the edge, of each of its triangles
  };
  std::map<Edge, Side> sides;  // sorted: the order of edges depends on nothing else
  std::vector<bool> is_used(site.size(), false);
  for (const Triangle& t : triangles) {
    const double third = triangle_area(rest, t) / 3;
    for (int k = 0; k < 3; ++k) {
      is_used[t[k]] = true;
      point_area[t[k]] += third;
      Side& side = sides[ordered(t[k], t[(k + 1) % 3])];
      side.area += third;
      side.away.push_back(away_from_edge(rest, {t[k], t[(k + 1) % 3]}, t[(k + 2) % 3]));
    }
    mesh.triangles.push_back({{site[t[0]], site[t[1]], site[t[2]]}, body});
  }
  for (std::size_t i = 0; i < site.size(); ++i) {
    if (!is_used[i]) continue;
    mesh.points.push_back({site[i], body, point_area[i]});
    if (mesh.rest.size() <= site[i])
      mesh.rest.resize(site[i] + 1, Vec3::Constant(std::numeric_limits<double>::quiet_NaN()));
    mesh.rest[site[i]] = rest[i];
  }
  const bool stays_plane = !mesh.bodies.at(body).collides_with_itself;
  for (const auto& [edge, side] : sides) {
    const bool is_flat = stays_plane && side.away.size() == 2 && (side.away[0] + side.away[1]).norm() <= FLAT;
    const double length = (rest[edge[0]] - rest[edge[1]]).norm();
    mesh.edges.push_back({{site[edge[0]], site[edge[1]]}, body, is_flat, side.area, length});
  }
}

std::size_t disable_pairs_within(CollisionMesh& mesh, u32 first_body, u32 second_body, std::span<const Vec3> x,
                                 double distance) {
  const std::size_t before = mesh.disabled_point_triangle.size() + mesh.disabled_edge_edge.size();
  const auto disable_points = [&](u32 body_of_points, u32 body_of_triangles) {
    const std::vector<u32> triangles = of_body(mesh.triangles, body_of_triangles);
    for (const u32 point : of_body(mesh.points, body_of_points))
      for (const u32 triangle : triangles) {
        const auto& t = mesh.triangles[triangle].site;
        if (point_triangle_distance(x[mesh.points[point].site], x[t[0]], x[t[1]], x[t[2]]) < distance)
          mesh.disabled_point_triangle.push_back({point, triangle});
      }
  };
  disable_points(first_body, second_body);
  if (first_body != second_body) disable_points(second_body, first_body);
  const std::vector<u32> second_edges = of_body(mesh.edges, second_body);
  for (const u32 a : of_body(mesh.edges, first_body))
    for (const u32 b : second_edges) {
      const auto &p = mesh.edges[a].site, &q = mesh.edges[b].site;
      if ((first_body != second_body || a < b) && edge_edge_distance(x[p[0]], x[p[1]], x[q[0]], x[q[1]]) < distance)
        mesh.disabled_edge_edge.push_back({a, b});
    }
  return mesh.disabled_point_triangle.size() + mesh.disabled_edge_edge.size() - before;
}

BodyPairTable make_body_pair_table(const CollisionMesh& mesh) {
  BodyPairTable table;
  table.n_bodies.assign(mesh.n_worlds, 0);
  for (const CollisionBody& body : mesh.bodies) table.index.push_back(table.n_bodies[body.world]++);
  std::vector<u32> first_body = {0};
  table.first = {0};
  for (const u32 n : table.n_bodies) {
    first_body.push_back(first_body.back() + n);
    table.first.push_back(table.first.back() + n * n);
  }
  std::map<BodyKey, double> given;
  for (const BodyPairFriction& pair : mesh.pair_friction) given[ordered(pair.first, pair.second)] = pair.coefficient;
  std::map<BodyKey, double> adhesion;
  for (const ContactEffect& effect : mesh.effects) adhesion[ordered(effect.first, effect.second)] += effect.adhesion;
  std::set<BodyKey> never;
  for (const auto& [a, b] : mesh.noncolliding_bodies) never.insert(ordered(a, b));
  for (u32 world = 0; world < mesh.n_worlds; ++world)
    for (u32 i = first_body[world]; i < first_body[world + 1]; ++i)
      for (u32 j = first_body[world]; j < first_body[world + 1]; ++j) {
        const CollisionBody &a = mesh.bodies[i], &b = mesh.bodies[j];
        const auto found = given.find(ordered(i, j));
        const bool may_touch =
            (i != j || a.collides_with_itself) && !(a.is_fixed && b.is_fixed) && !never.contains(ordered(i, j));
        const double mean = i == j ? a.friction : std::sqrt(a.friction * b.friction);
        const auto sticks = adhesion.find(ordered(i, j));
        table.adhesion.push_back(sticks == adhesion.end() ? 0 : sticks->second);
        table.friction.push_back(!may_touch ? -1 : found != given.end() ? found->second : mean);
      }
  return table;
}

void check_collision_mesh(const CollisionMesh& mesh, std::size_t n_sites) {
  u32 world = 0;
  for (const CollisionBody& body : mesh.bodies) {
    if (body.world < world) throw std::logic_error("collision bodies are not sorted by world");
    world = body.world;
    if (!(body.offset >= 0) || !(body.friction >= 0))
      throw std::logic_error("a collision body has a negative contact offset or coefficient of friction");
  }
  if (world >= mesh.n_worlds) throw std::logic_error("a collision body lies in a world that does not exist");
  check_primitives(mesh, mesh.points, n_sites, "point");
  check_primitives(mesh, mesh.edges, n_sites, "edge");
  check_primitives(mesh, mesh.triangles, n_sites, "triangle");
}

namespace {

// Edges and triangles of one world, and which pairs of them are left out.
struct WorldSurface {
  std::vector<Edge> edges;
  std::vector<Triangle> triangles;
  u32 first_edge = 0, first_triangle = 0;
};

WorldSurface surface_of_world(const CollisionMesh& mesh, u32 world) {
  WorldSurface surface;
  const auto is_before = [&](const auto& primitive) { return mesh.bodies[primitive.body].world < world; };
  const auto edge = std::partition_point(mesh.edges.begin(), mesh.edges.end(), is_before);
  const auto triangle = std::partition_point(mesh.triangles.begin(), mesh.triangles.end(), is_before);
  surface.first_edge = u32(edge - mesh.edges.begin());
  surface.first_triangle = u32(triangle - mesh.triangles.begin());
  for (auto e = edge; e != mesh.edges.end() && mesh.bodies[e->body].world == world; ++e)
    surface.edges.push_back({e->site[0], e->site[1]});
  for (auto t = triangle; t != mesh.triangles.end() && mesh.bodies[t->body].world == world; ++t)
    surface.triangles.push_back({t->site[0], t->site[1], t->site[2]});
  return surface;
}

// An edge and a triangle are left out where a recorded pair is part of them: an end of the edge with the triangle, or
// the edge with a side of the triangle.
std::set<std::array<u32, 2>> disabled_edge_triangle(const CollisionMesh& mesh) {
  std::set<std::array<u32, 2>> disabled;
  if (mesh.disabled_point_triangle.empty() && mesh.disabled_edge_edge.empty()) return disabled;
  std::map<u32, std::vector<u32>> edges_of_site;
  std::map<Edge, std::vector<u32>> triangles_of_side;
  for (u32 e = 0; e < mesh.edges.size(); ++e)
    for (const u32 site : mesh.edges[e].site) edges_of_site[site].push_back(e);
  for (u32 t = 0; t < mesh.triangles.size(); ++t)
    for (int k = 0; k < 3; ++k)
      triangles_of_side[ordered(mesh.triangles[t].site[k], mesh.triangles[t].site[(k + 1) % 3])].push_back(t);
  for (const auto& [point, triangle] : mesh.disabled_point_triangle)
    for (const u32 e : edges_of_site[mesh.points[point].site]) disabled.insert({e, triangle});
  const auto disable_sides = [&](u32 edge, u32 side) {
    for (const u32 t : triangles_of_side[ordered(mesh.edges[side].site[0], mesh.edges[side].site[1])])
      disabled.insert({edge, t});
  };
  for (const auto& [a, b] : mesh.disabled_edge_edge) {
    disable_sides(a, b);
    disable_sides(b, a);
  }
  return disabled;
}

// the first point that lies on or below the plane of a half-space that it may touch
std::optional<StartConflict> find_point_below(const CollisionMesh& mesh, const BodyPairTable& table,
                                              std::span<const Vec3> x) {
  for (const CollisionTriangle& plane : mesh.triangles) {
    if (!mesh.bodies[plane.body].is_half_space) continue;
    const u32 world = mesh.bodies[plane.body].world;
    for (const CollisionPoint& point : mesh.points)
      if (mesh.bodies[point.body].world == world && table(mesh, point.body, plane.body) >= 0 &&
          orientation_sign(x[plane.site[0]], x[plane.site[1]], x[plane.site[2]], x[point.site]) <= 0)
        return StartConflict{world, point.body, plane.body, point.site, plane.site[0], true, 0};
  }
  return std::nullopt;
}

}  // namespace

std::optional<StartConflict> find_surface_intersection(const CollisionMesh& mesh, std::span<const Vec3> x) {
  const BodyPairTable table = make_body_pair_table(mesh);
  if (const auto below = find_point_below(mesh, table, x)) return below;
  const std::set<std::array<u32, 2>> disabled = disabled_edge_triangle(mesh);
  for (u32 world = 0; world < mesh.n_worlds; ++world) {
    const WorldSurface surface = surface_of_world(mesh, world);
    const auto is_excluded = [&](u32 edge, u32 triangle) {
      const u32 e = surface.first_edge + edge, t = surface.first_triangle + triangle;
      const u32 body = mesh.triangles[t].body;
      return mesh.bodies[body].is_half_space || table(mesh, mesh.edges[e].body, body) < 0 || disabled.contains({e, t});
    };
    if (const auto pair = find_intersection(x, surface.edges, surface.triangles, is_excluded)) {
      const CollisionEdge& edge = mesh.edges[surface.first_edge + pair->edge];
      const CollisionTriangle& triangle = mesh.triangles[surface.first_triangle + pair->triangle];
      return StartConflict{world, edge.body, triangle.body, edge.site[0], triangle.site[0], true, 0};
    }
  }
  return std::nullopt;
}

std::optional<StartConflict> find_enclosed_body(const CollisionMesh& mesh, std::span<const Vec3> x) {
  const BodyPairTable table = make_body_pair_table(mesh);
  const std::size_t n = mesh.bodies.size();
  std::vector<Eigen::AlignedBox3d> box(n);
  std::vector<std::vector<Triangle>> triangles(n);
  for (const CollisionTriangle& t : mesh.triangles) {
    if (mesh.bodies[t.body].is_half_space) continue;  // its triangle bounds nothing
    triangles[t.body].push_back({t.site[0], t.site[1], t.site[2]});
    for (const u32 site : t.site) box[t.body].extend(x[site]);
  }
  for (u32 outer = 0; outer < n; ++outer) {
    const u32 first = outer - table.index[outer], last = first + table.n_bodies[mesh.bodies[outer].world];
    for (u32 inner = first; inner < last; ++inner) {
      if (inner == outer || triangles[inner].empty() || table(mesh, inner, outer) < 0) continue;
      if (!box[outer].contains(box[inner])) continue;
      const u32 site = triangles[inner].front()[0];
      // only a closed surface goes around a point once as a whole
      if (winding_number(x, triangles[outer], x[site]) > 0.99)
        return StartConflict{mesh.bodies[outer].world, inner, outer, site, triangles[outer].front()[0], true, 0};
    }
  }
  return std::nullopt;
}

}  // namespace pvg
