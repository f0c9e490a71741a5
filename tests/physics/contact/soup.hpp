// Worlds of triangle soup, and the loop over all of their pairs.
#pragma once
#include <algorithm>
#include <array>
#include <random>
#include <set>

#include "host/geometry/segment_distance.hpp"
#include "host/physics/contact/broad_phase.hpp"

namespace pvg::test {

class Numbers {
 public:
  explicit Numbers(unsigned seed) : engine_(seed) {}
  double number(double low, double high) { return low + (high - low) * (engine_() / 4294967296.0); }
  Vec3 vector(double size) {
    const double x = number(-size, size), y = number(-size, size);
    return Vec3(x, y, number(-size, size));
  }
  u32 below(u32 n) { return engine_() % n; }

 private:
  std::mt19937 engine_;
};

struct Soup {
  CollisionMesh mesh;
  std::vector<Vec3> rest, x0, x1;  // [n_sites, m]
};

// Adds a world with n_bodies bodies of n triangles each, some of which share corners; the first two bodies are fixed,
// the third collides with itself, bodies 0 and 3 never touch.
inline void add_world(Soup& soup, Numbers& random, u32 n_bodies, u32 n) {
  CollisionMesh& mesh = soup.mesh;
  const u32 world = mesh.n_worlds++, first_body = u32(mesh.bodies.size());
  for (u32 b = 0; b < n_bodies; ++b) {
    mesh.bodies.push_back({.world = world,
                           .collides_with_itself = b == 2,
                           .is_fixed = b < 2,
                           .offset = b == 1 ? 0.004 : 0,
                           .friction = 0.1 * (b + 1)});
    std::vector<u32> site;
    std::vector<Vec3> rest;
    std::vector<Triangle> triangles;
    for (u32 t = 0; t < n; ++t) {
      Triangle triangle;
      const Vec3 center = random.vector(0.1);
      for (u32 k = 0; k < 3; ++k) {
        if (rest.size() > 3 && random.below(4) == 0) {
          do triangle[k] = random.below(u32(rest.size()));
          while (std::count(&triangle[0], &triangle[k], triangle[k]));
          continue;
        }
        triangle[k] = u32(rest.size());
        site.push_back(u32(soup.x0.size()));
        rest.push_back(center + random.vector(0.02));
        soup.x0.push_back(rest.back());
        soup.x1.push_back(rest.back() + random.vector(0.01));
      }
      triangles.push_back(triangle);
    }
    add_surface(mesh, first_body + b, site, rest, triangles);
  }
  soup.rest = soup.x0;
  if (n_bodies > 3) mesh.noncolliding_bodies.push_back({first_body + 3, first_body});
}

inline Soup soup_of(std::initializer_list<std::array<u32, 3>> worlds) {
  Soup soup;
  soup.mesh.n_worlds = 0;
  for (const auto& [seed, n_bodies, n] : worlds) {
    Numbers random(seed);
    add_world(soup, random, n_bodies, n);
  }
  return soup;
}

inline Buffer<double> upload(Device& device, const std::vector<Vec3>& x) {
  std::vector<double> values;
  for (const Vec3& point : x) values.insert(values.end(), {point[0], point[1], point[2]});
  return Buffer<double>(device, values, "x");
}

inline constexpr double ACTIVATION = 0.003;

template <std::size_t N>
struct Corners {
  std::array<u32, N> site;
  u32 body;
};

template <class At>
double distance(const At& at, const Corners<1>& p, const Corners<3>& q) {
  return point_triangle_distance(at(p.site[0]), at(q.site[0]), at(q.site[1]), at(q.site[2]));
}
template <class At>
double distance(const At& at, const Corners<2>& p, const Corners<2>& q) {
  return edge_edge_distance(at(p.site[0]), at(p.site[1]), at(q.site[0]), at(q.site[1]));
}

// What is left of their distance at time t of the motion before they act on each other [m]: within one body from half
// the gap at rest on, with an offset of at most half the distance at rest.
template <std::size_t N, std::size_t M>
double inactive_gap(const Soup& soup, const Corners<N>& p, const Corners<M>& q, double t) {
  const auto moved = [&](u32 site) -> Vec3 { return (1 - t) * soup.x0[site] + t * soup.x1[site]; };
  const auto at_rest = [&](u32 site) -> Vec3 { return soup.rest[site]; };
  double offset = soup.mesh.bodies[p.body].offset + soup.mesh.bodies[q.body].offset, activation = ACTIVATION;
  if (p.body == q.body) {
    const double rest = distance(at_rest, p, q);
    offset = std::min(offset, rest / 2);
    activation = std::min(activation, (rest - offset) / 2);
  }
  return distance(moved, p, q) - offset - activation;
}

// the longest way of a corner [m]
template <std::size_t N>
double way(const Soup& soup, const Corners<N>& corners) {
  double longest = 0;
  for (const u32 site : corners.site) longest = std::max(longest, (soup.x1[site] - soup.x0[site]).norm());
  return longest;
}

// what must be found: pairs that are seen to come within activation distance at one of many times;
// what may be found: those that half the ways of both, from halfway, could bring there
enum class Which { must, may };
template <std::size_t N, std::size_t M>
bool comes_near(const Soup& soup, const Corners<N>& p, const Corners<M>& q, Which which) {
  if (which == Which::may) return inactive_gap(soup, p, q, 0.5) < way(soup, p) + way(soup, q);
  for (int i = 0; i <= 16; ++i)
    if (inactive_gap(soup, p, q, i / 16.0) < -1e-12) return true;
  return false;
}

inline bool are_allowed(const CollisionMesh& mesh, u32 a, u32 b) {
  const CollisionBody &p = mesh.bodies[a], &q = mesh.bodies[b];
  if (p.world != q.world || (p.is_fixed && q.is_fixed) || (a == b && !p.collides_with_itself)) return false;
  for (const auto& [c, d] : mesh.noncolliding_bodies)
    if ((a == c && b == d) || (a == d && b == c)) return false;
  return true;
}

template <std::size_t N, std::size_t M>
bool share_a_site(const Corners<N>& a, const Corners<M>& b) {
  return std::any_of(a.site.begin(), a.site.end(),
                     [&](u32 site) { return std::count(b.site.begin(), b.site.end(), site); });
}

using Key = std::array<u32, 5>;
inline Key key_of(const Barrier& row) {
  // edge pairs come in either order
  std::array<std::array<u32, 2>, 2> edge = {{{row.site[0], row.site[1]}, {row.site[2], row.site[3]}}};
  if (row.kind == EDGE_EDGE && edge[1] < edge[0]) std::swap(edge[0], edge[1]);
  return {row.kind, edge[0][0], edge[0][1], edge[1][0], edge[1][1]};
}

inline std::set<Key> all_pairs(const Soup& soup, Which which) {
  using Pairs = std::set<std::array<u32, 2>>;
  const CollisionMesh& mesh = soup.mesh;
  const Pairs no_triangles(mesh.disabled_point_triangle.begin(), mesh.disabled_point_triangle.end());
  const Pairs no_edges(mesh.disabled_edge_edge.begin(), mesh.disabled_edge_edge.end());
  std::set<Key> found;
  const auto is_pair = [&](const auto& a, const auto& b) {
    return are_allowed(mesh, a.body, b.body) && !share_a_site(a, b) && comes_near(soup, a, b, which);
  };
  for (u32 p = 0; p < mesh.points.size(); ++p)
    for (u32 t = 0; t < mesh.triangles.size(); ++t) {
      const Corners<1> a{{mesh.points[p].site}, mesh.points[p].body};
      const auto& s = mesh.triangles[t].site;
      const Corners<3> b{{s[0], s[1], s[2]}, mesh.triangles[t].body};
      if (!no_triangles.contains({p, t}) && is_pair(a, b)) found.insert({POINT_TRIANGLE, a.site[0], s[0], s[1], s[2]});
    }
  for (u32 i = 0; i < mesh.edges.size(); ++i)
    for (u32 j = i + 1; j < mesh.edges.size(); ++j) {
      const Corners<2> a{{mesh.edges[i].site[0], mesh.edges[i].site[1]}, mesh.edges[i].body},
          b{{mesh.edges[j].site[0], mesh.edges[j].site[1]}, mesh.edges[j].body};
      Barrier row{};
      row.kind = EDGE_EDGE;
      std::copy_n(a.site.begin(), 2, row.site);
      std::copy_n(b.site.begin(), 2, row.site + 2);
      if (!no_edges.contains({i, j}) && !no_edges.contains({j, i}) && is_pair(a, b)) found.insert(key_of(row));
    }
  return found;
}

// two worlds in which the last body is a sheet that may touch itself
inline Soup soup_with_sheets() {
  Soup soup = soup_of({{{7, 5, 30}}, {{8, 5, 20}}});
  for (CollisionBody& body : soup.mesh.bodies)
    if (&body == &soup.mesh.bodies[4] || &body == &soup.mesh.bodies[9])
      body.offset = 0.002, body.collides_with_itself = true;
  return soup;
}

// of each world
inline std::vector<std::multiset<Key>> keys_of(const WorldRows<Barrier>& pairs) {
  const std::vector<Barrier> rows = pairs.rows.read();
  std::vector<std::multiset<Key>> keys;
  for (std::size_t w = 0; w + 1 < pairs.first.size(); ++w) {
    keys.emplace_back();
    for (u32 i = pairs.first[w]; i < pairs.first[w + 1]; ++i) keys.back().insert(key_of(rows[i]));
  }
  return keys;
}

inline WorldRows<Barrier> find(Device& device, const Soup& soup, PairsOf which) {
  const std::vector<ContactSettings> settings(soup.mesh.n_worlds, {.activation_distance = ACTIVATION});
  BroadPhase broad_phase(device, soup.mesh, settings, soup.x0, which);
  WorldRows<Barrier> pairs{Buffer<Barrier>(device, 0, "pairs"), {}};
  broad_phase.find(upload(device, soup.x0), upload(device, soup.x1), 0, pairs);
  return pairs;
}

}  // namespace pvg::test
