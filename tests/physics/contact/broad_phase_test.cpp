// Candidate pairs against the loop over all pairs, for several worlds of triangle soup; and a world alone against the
// same world in company.
#include "host/physics/contact/broad_phase.hpp"

#include <gtest/gtest.h>

#include <cstdlib>

#include "tests/physics/contact/soup.hpp"

namespace pvg::test {
namespace {

WorldRows<Barrier> find(Device& device, const Soup& soup) {
  const std::vector<ContactSettings> settings(soup.mesh.n_worlds, {.activation_distance = ACTIVATION});
  BroadPhase broad_phase(device, soup.mesh, settings, soup.x0);
  WorldRows<Barrier> pairs{Buffer<Barrier>(device, 0, "pairs"), {}};
  broad_phase.find(upload(device, soup.x0), upload(device, soup.x1), 0, pairs);
  // once more: growing buffers must not matter
  broad_phase.find(upload(device, soup.x0), upload(device, soup.x1), 0, pairs);
  return pairs;
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

}  // namespace
}  // namespace pvg::test
