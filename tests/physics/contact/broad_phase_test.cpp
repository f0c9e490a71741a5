// Candidate pairs against the loop over all pairs, for several worlds of triangle soup; and a world alone against the
// same world in company.
#include "host/physics/contact/broad_phase.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <random>
#include <set>

#include "host/geometry/segment_distance.hpp"
#include "host/physics/contact/candidates.hpp"
#include "host/physics/contact/continuous_collision.hpp"

namespace pvg {
namespace {

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
void add_world(Soup& soup, Numbers& random, u32 n_bodies, u32 n) {
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

Soup soup_of(std::initializer_list<std::array<u32, 3>> worlds) {
  Soup soup;
  soup.mesh.n_worlds = 0;
  for (const auto& [seed, n_bodies, n] : worlds) {
    Numbers random(seed);
    add_world(soup, random, n_bodies, n);
  }
  return soup;
}

Buffer<double> upload(Device& device, const std::vector<Vec3>& x) {
  std::vector<double> values;
  for (const Vec3& point : x) values.insert(values.end(), {point[0], point[1], point[2]});
  return Buffer<double>(device, values, "x");
}

constexpr double ACTIVATION = 0.003;

WorldRows<Barrier> find(Device& device, const Soup& soup) {
  const std::vector<ContactSettings> settings(soup.mesh.n_worlds, {.activation_distance = ACTIVATION});
  BroadPhase broad_phase(device, soup.mesh, settings, soup.x0);
  WorldRows<Barrier> pairs{Buffer<Barrier>(device, 0, "pairs"), {}};
  broad_phase.find(upload(device, soup.x0), upload(device, soup.x1), 0, pairs);
  // once more: growing buffers must not matter
  broad_phase.find(upload(device, soup.x0), upload(device, soup.x1), 0, pairs);
  return pairs;
}

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

bool are_allowed(const CollisionMesh& mesh, u32 a, u32 b) {
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
Key key_of(const Barrier& row) {
  // edge pairs come in either order
  std::array<std::array<u32, 2>, 2> edge = {{{row.site[0], row.site[1]}, {row.site[2], row.site[3]}}};
  if (row.kind == EDGE_EDGE && edge[1] < edge[0]) std::swap(edge[0], edge[1]);
  return {row.kind, edge[0][0], edge[0][1], edge[1][0], edge[1][1]};
}

std::set<Key> all_pairs(const Soup& soup, Which which) {
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

void expect_all_pairs(Device& device, const Soup& soup) {
  const WorldRows<Barrier> pairs = find(device, soup);
  std::set<Key> found;
  const std::vector<Barrier> rows = pairs.rows.read();
  for (const Barrier& row : rows) ASSERT_TRUE(found.insert(key_of(row)).second) << "a pair was found twice";
  const std::set<Key> must = all_pairs(soup, Which::must), may = all_pairs(soup, Which::may);
  EXPECT_TRUE(std::includes(found.begin(), found.end(), must.begin(), must.end()))
      << found.size() << " " << must.size();
  EXPECT_TRUE(std::includes(may.begin(), may.end(), found.begin(), found.end())) << found.size() << " " << may.size();
  for (u32 world = 0; world < soup.mesh.n_worlds; ++world)
    for (u32 i = pairs.first[world]; i < pairs.first[world + 1]; ++i) ASSERT_EQ(rows[i].world, world);
}

TEST(BroadPhase, FindsTheSamePairsAsTheLoopOverAll) {
  Device device;
  // Oclgrind runs a thousand times slower
  if (std::getenv("PVG_OCLGRIND")) {
    expect_all_pairs(device, soup_of({{1, 4, 5}, {2, 3, 1}, {6, 0, 0}}));
    return;
  }
  expect_all_pairs(device, soup_of({{1, 4, 60}}));
  expect_all_pairs(device, soup_of({{1, 4, 60}, {2, 3, 1}, {3, 5, 40}}));
  expect_all_pairs(device, soup_of({{4, 1, 1}}));
  expect_all_pairs(device, soup_of({{5, 3, 3}, {6, 0, 0}, {7, 3, 100}}));  // a world without anything
  expect_all_pairs(device, soup_of({{6, 0, 0}}));
}

TEST(BroadPhase, DisabledElementPairsAreNotFound) {
  if (std::getenv("PVG_OCLGRIND")) GTEST_SKIP() << "the first test runs the same kernels";
  Device device;
  Soup soup = soup_of({{1, 4, 60}, {9, 4, 60}});
  const std::size_t before = find(device, soup).n();
  std::size_t n_disabled = 0;
  for (const u32 body : {0u, 4u}) n_disabled += disable_pairs_within(soup.mesh, body, body + 2, soup.x0, 0.01);
  n_disabled += disable_pairs_within(soup.mesh, 2, 2, soup.x0, 0.01);
  EXPECT_GT(n_disabled, 20u);
  EXPECT_LT(find(device, soup).n(), before);
  expect_all_pairs(device, soup);
}

TEST(BroadPhase, AWorldDoesNotNoticeItsCompany) {
  if (std::getenv("PVG_OCLGRIND")) GTEST_SKIP() << "the first test runs the same kernels";
  Device device;
  const Soup alone = soup_of({{3, 5, 40}}), company = soup_of({{1, 4, 90}, {3, 5, 40}, {2, 3, 10}});
  const WorldRows<Barrier> some = find(device, alone), all = find(device, company);
  const std::vector<Barrier> expected = some.rows.read();
  std::vector<Barrier> found = all.rows.read(all.first[1], all.first[2] - all.first[1]);
  ASSERT_EQ(found.size(), expected.size());
  ASSERT_GT(found.size(), 100u);
  const u32 first_site = company.mesh.triangles[4 * 90].site[0] - alone.mesh.triangles[0].site[0];
  for (std::size_t i = 0; i < found.size(); ++i) {
    for (u32& site : found[i].site) site -= first_site;
    for (u32& body : found[i].body) body -= 4;
    found[i].world = 0;
    ASSERT_EQ(std::memcmp(&found[i], &expected[i], sizeof(Barrier)), 0) << i;
  }
}

TEST(BroadPhase, RowsCarryAreaOffsetFrictionAndMollifier) {
  if (std::getenv("PVG_OCLGRIND")) GTEST_SKIP() << "the first test runs the same kernels";
  Device device;
  const Soup soup = soup_of({{1, 4, 60}});
  const CollisionMesh& mesh = soup.mesh;
  for (const Barrier& row : find(device, soup).rows.read()) {
    const u32 a = row.body[0], b = row.body[1];
    // the test of all pairs proves where parts of one body act
    if (a != b) {
      ASSERT_NEAR(row.offset, mesh.bodies[a].offset + mesh.bodies[b].offset, 1e-18);
      ASSERT_EQ(row.activation_distance, ACTIVATION);
    }
    ASSERT_NEAR(row.friction, std::sqrt(0.1 * (a + 1) * 0.1 * (b + 1)), 1e-15);
    const auto edge = [&](u32 p, u32 q) {
      return *std::find_if(mesh.edges.begin(), mesh.edges.end(),
                           [&](const CollisionEdge& e) { return e.site[0] == p && e.site[1] == q; });
    };
    if (row.kind == EDGE_EDGE) {
      const CollisionEdge e = edge(row.site[0], row.site[1]), f = edge(row.site[2], row.site[3]);
      ASSERT_EQ(row.area, std::min(e.area, f.area));
      const double size = (soup.x0[row.site[1]] - soup.x0[row.site[0]]).squaredNorm() *
                          (soup.x0[row.site[3]] - soup.x0[row.site[2]]).squaredNorm();
      ASSERT_NEAR(row.mollifier_threshold, 1e-3 * size, 1e-15 * size);
    } else {
      ASSERT_EQ(row.mollifier_threshold, 0);
      const auto point = std::find_if(mesh.points.begin(), mesh.points.end(),
                                      [&](const CollisionPoint& p) { return p.site == row.site[0]; });
      ASSERT_EQ(row.area, point->area);
    }
  }
}

TEST(CollisionMesh, AreasOfPointsAndEdgesAddUpToTheSurface) {
  CollisionMesh mesh;
  mesh.bodies.push_back({});
  const std::vector<u32> site = {5, 6, 7, 8, 9};
  // two right triangles of 3 x 4 and a point that no triangle uses
  const std::vector<Vec3> rest = {Vec3(0, 0, 0), Vec3(3, 0, 0), Vec3(3, 4, 0), Vec3(0, 4, 0), Vec3(9, 9, 9)};
  add_surface(mesh, 0, site, rest, std::vector<Triangle>{{0, 1, 2}, {0, 2, 3}});
  ASSERT_EQ(mesh.points.size(), 4u);
  ASSERT_EQ(mesh.edges.size(), 5u);
  EXPECT_DOUBLE_EQ(mesh.points[0].area, 4);  // a third of 6 m^2 from each
  EXPECT_DOUBLE_EQ(mesh.points[1].area, 2);
  double points = 0, edges = 0;
  for (const CollisionPoint& p : mesh.points) points += p.area;
  for (const CollisionEdge& e : mesh.edges) edges += e.area;
  EXPECT_DOUBLE_EQ(points, 12);
  EXPECT_DOUBLE_EQ(edges, 12);
  EXPECT_DOUBLE_EQ(mesh.edges[1].rest_length, 5);
}

TEST(CollisionMesh, UnsortedWorldsAreRefused) {
  Soup soup = soup_of({{1, 2, 5}, {2, 2, 5}});
  check_collision_mesh(soup.mesh, soup.x0.size());
  std::swap(soup.mesh.triangles.front(), soup.mesh.triangles.back());
  EXPECT_THROW(check_collision_mesh(soup.mesh, soup.x0.size()), std::logic_error);
  EXPECT_THROW(check_collision_mesh(soup_of({{1, 2, 5}}).mesh, 3), std::logic_error);
}

// two worlds in which the last body is a sheet that may touch itself
Soup soup_with_sheets() {
  Soup soup = soup_of({{{7, 5, 30}}, {{8, 5, 20}}});
  for (CollisionBody& body : soup.mesh.bodies)
    if (&body == &soup.mesh.bodies[4] || &body == &soup.mesh.bodies[9])
      body.offset = 0.002, body.collides_with_itself = true;
  return soup;
}

// of each world
std::vector<std::multiset<Key>> keys_of(const WorldRows<Barrier>& pairs) {
  const std::vector<Barrier> rows = pairs.rows.read();
  std::vector<std::multiset<Key>> keys;
  for (std::size_t w = 0; w + 1 < pairs.first.size(); ++w) {
    keys.emplace_back();
    for (u32 i = pairs.first[w]; i < pairs.first[w + 1]; ++i) keys.back().insert(key_of(rows[i]));
  }
  return keys;
}

WorldRows<Barrier> find(Device& device, const Soup& soup, PairsOf which) {
  const std::vector<ContactSettings> settings(soup.mesh.n_worlds, {.activation_distance = ACTIVATION});
  BroadPhase broad_phase(device, soup.mesh, settings, soup.x0, which);
  WorldRows<Barrier> pairs{Buffer<Barrier>(device, 0, "pairs"), {}};
  broad_phase.find(upload(device, soup.x0), upload(device, soup.x1), 0, pairs);
  return pairs;
}

Soup soup_at_rest(Soup soup) {
  soup.x1 = soup.x0;
  return soup;
}

TEST(BroadPhase, PairsOfSolidsOfSheetsAndOfTwoBodiesAreAllPairs) {
  Device device;
  const Soup soup = soup_with_sheets();
  const auto all = keys_of(find(device, soup, PairsOf::all_bodies));
  std::vector<std::multiset<Key>> together(all.size());
  for (const PairsOf which : {PairsOf::one_solid, PairsOf::one_sheet, PairsOf::two_bodies}) {
    const auto part = keys_of(find(device, soup, which));
    for (std::size_t w = 0; w < all.size(); ++w) {
      EXPECT_FALSE(part[w].empty());
      together[w].insert(part[w].begin(), part[w].end());
    }
  }
  EXPECT_EQ(together, all);
}

// nothing moves at first; then one body alone, so that the lists of the others still serve
TEST(Candidates, WhatHasMovedIsLookedForAgain) {
  Device device;
  const Soup soup = soup_with_sheets();
  const std::vector<ContactSettings> settings(soup.mesh.n_worlds, {.activation_distance = ACTIVATION});
  for (const u32 moving : {2u, 4u}) {
    Candidates candidates(device, soup.mesh, settings, soup.x0, 0.001, 0.0001);
    candidates.find(upload(device, soup.x0), upload(device, soup.x0));
    Soup moved = soup;
    moved.x1 = soup.x0;
    for (const CollisionPoint& point : soup.mesh.points)
      if (point.body == moving) moved.x1[point.site] = soup.x1[point.site];
    candidates.find(upload(device, moved.x0), upload(device, moved.x1));
    const auto found = keys_of(candidates.rows()), needed = keys_of(find(device, moved, PairsOf::all_bodies));
    ASSERT_EQ(found.size(), needed.size());
    for (std::size_t w = 0; w < needed.size(); ++w) {
      EXPECT_GT(needed[w].size(), 20u);
      EXPECT_TRUE(std::includes(found[w].begin(), found[w].end(), needed[w].begin(), needed[w].end())) << w;
    }
    // and the search was needed: before it, some of these pairs were missing
    const auto before = keys_of(find(device, soup_at_rest(soup), PairsOf::all_bodies));
    EXPECT_FALSE(std::includes(before[0].begin(), before[0].end(), needed[0].begin(), needed[0].end()));
  }
}

// of one body
std::size_t count_within(const WorldRows<Barrier>& pairs) {
  const std::vector<Barrier> rows = pairs.rows.read();
  return std::size_t(
      std::count_if(rows.begin(), rows.end(), [](const Barrier& row) { return row.body[0] == row.body[1]; }));
}

// Everything turns together and every site wanders: by turns too little for a search, and enough.
TEST(Candidates, NoPairIsLostOnTheWayWhateverTheMargin) {
  if (std::getenv("PVG_OCLGRIND")) GTEST_SKIP() << "the tests above run the same kernels";
  Device device;
  constexpr double MARGIN = 0.002;
  std::size_t n_within[2];
  for (const bool smaller : {false, true}) {
    Soup soup = soup_with_sheets();
    const std::vector<ContactSettings> settings(soup.mesh.n_worlds, {.activation_distance = ACTIVATION});
    Candidates candidates(device, soup.mesh, settings, soup.x0, MARGIN, smaller ? MARGIN / 16 : MARGIN);
    Numbers random(11);
    std::size_t n_kept = 0;
    for (int motion = 0; motion < 8; ++motion) {
      const Eigen::AngleAxisd turn(0.02, Vec3(1, 2, 3).normalized());
      const double size = motion % 2 == 0 ? 0.004 : MARGIN / 100;
      for (std::size_t i = 0; i < soup.x0.size(); ++i)
        soup.x1[i] = (motion % 4 == 1 ? turn * soup.x0[i] : soup.x0[i]) + random.vector(size);
      const Buffer<double> x0 = upload(device, soup.x0), x1 = upload(device, soup.x1);
      candidates.start_check(x0, x1);
      device.finish();
      const Candidates::Lists lacking = candidates.renew(x0, x1);
      n_kept += !lacking[Candidates::SOLIDS] + !lacking[Candidates::SHEETS];
      if (motion == 0) n_within[smaller] = count_within(candidates.rows());
      std::set<Key> found;
      for (const std::multiset<Key>& world : keys_of(candidates.rows())) found.insert(world.begin(), world.end());
      const std::set<Key> must = all_pairs(soup, Which::must);
      EXPECT_GT(must.size(), 50u);
      EXPECT_TRUE(std::includes(found.begin(), found.end(), must.begin(), must.end()))
          << "motion " << motion << ", " << found.size() << " of " << must.size();
      soup.x0 = soup.x1;
    }
    EXPECT_GE(n_kept, 4u);  // lists that served although something had moved or turned
  }
  EXPECT_LT(n_within[1], n_within[0]);
}

// Rows as they lie on the device, and the worlds' first ones there.
void expect_same_rows(const Candidates& expected, const Candidates& found) {
  ASSERT_EQ(expected.rows().first, found.rows().first);
  EXPECT_EQ(expected.first().read(), found.first().read());
  const std::vector<Barrier> a = expected.rows().rows.read(0, expected.rows().n()),
                             b = found.rows().rows.read(0, found.rows().n());
  EXPECT_EQ(std::memcmp(a.data(), b.data(), a.size() * sizeof(Barrier)), 0);
}

// What was found without waiting is what waiting finds; of what has no room it is told, and it is found then.
TEST(Candidates, WithoutWaitingTheyAreTheSame) {
  if (std::getenv("PVG_OCLGRIND")) GTEST_SKIP() << "the tests above run the same kernels";
  Device device;
  constexpr double MARGIN = 0.002;
  const Soup soup = soup_with_sheets();
  const std::vector<ContactSettings> settings(soup.mesh.n_worlds, {.activation_distance = ACTIVATION});
  Candidates late(device, soup.mesh, settings, soup.x0, MARGIN, MARGIN);
  Numbers random(5);
  int n_fitting = 0, n_lacking = 0;
  // the bodies' parts come together by turns, so that there are more pairs, or fewer
  for (const double size : {1.0, 1.02, 0.7, 0.71, 0.5, 1.0}) {
    std::vector<Vec3> x = soup.x0;
    for (Vec3& point : x) point = size * point + random.vector(0.0005);
    const Buffer<double> at = upload(device, x);
    Candidates waiting(device, soup.mesh, settings, soup.x0, MARGIN, MARGIN);
    waiting.find(at, at);
    late.start_check(at, at);
    late.start_renew(at, at, {true, true, true});
    device.finish();
    const bool fits = late.serve();
    ++(fits ? n_fitting : n_lacking);
    if (fits) {  // behind what was found is nothing that has a force or a world
      const std::vector<u32> first = late.first().read();
      const std::vector<Barrier> rows = late.rows().rows.read();
      for (std::size_t i = first.back(); i < rows.size(); ++i)
        EXPECT_TRUE(rows[i].area == 0 && rows[i].world == soup.mesh.n_worlds) << i << " of " << rows.size();
    }
    late.renew(at, at);
    expect_same_rows(waiting, late);
  }
  EXPECT_GT(n_fitting, 1);
  EXPECT_GT(n_lacking, 0);
}

// One launch does both: what it says of the lists and of each pair is what two launches say.
TEST(Candidates, CheckedAndCertifiedInOneLaunchTheyAreTheSame) {
  Device device;
  constexpr double MARGIN = 0.004;
  const Soup soup = soup_with_sheets();
  const std::vector<ContactSettings> settings(soup.mesh.n_worlds, {.activation_distance = ACTIVATION});
  Candidates candidates(device, soup.mesh, settings, soup.x0, MARGIN, MARGIN);
  ContinuousCollision collision(device);
  const Buffer<double> x0 = upload(device, soup.x0);
  candidates.find(x0, x0);
  ASSERT_GT(candidates.rows().n(), 2 * GROUP_SIZE);
  Numbers random(3);
  for (const double size : {MARGIN / 100, 10 * MARGIN}) {
    std::vector<Vec3> moved = soup.x0;
    for (Vec3& point : moved) point += random.vector(size);
    const Buffer<double> x1 = upload(device, moved);
    candidates.start_check(x0, x1);
    const std::vector<double> alone = collision.start(candidates.rows(), x0, x1).read(),
                              least_alone = collision.of_64().read();
    const Candidates::Lists lacked = candidates.lacking();
    EXPECT_EQ(candidates.serve(), size < MARGIN);
    const auto n_whole = std::ranges::count(alone, 1.0);
    EXPECT_TRUE(n_whole > 0 && n_whole < std::ptrdiff_t(alone.size())) << n_whole << " of " << alone.size();

    Buffer<double>& steps = collision.steps(candidates.rows().n());
    steps.write(std::vector<double>(alone.size(), -1));
    collision.of_64().write(std::vector<double>(least_alone.size(), -1));
    candidates.defer_check();
    candidates.start_certify(x0, x1, steps, collision.of_64());
    EXPECT_EQ(steps.read(), alone);
    EXPECT_EQ(collision.of_64().read(), least_alone);
    EXPECT_EQ(candidates.lacking(), lacked);
  }
}

}  // namespace
}  // namespace pvg
