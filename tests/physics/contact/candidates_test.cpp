// Pairs that are looked for somewhat farther than contact reaches: none is lost while they serve, and what is started
// without waiting finds the same.
#include "host/physics/contact/candidates.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>

#include "host/physics/contact/continuous_collision.hpp"
#include "tests/physics/contact/soup.hpp"

namespace pvg::test {
namespace {

Soup soup_at_rest(Soup soup) {
  soup.x1 = soup.x0;
  return soup;
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
}  // namespace pvg::test
