// From thousands of candidates to the list of contacts (pair_gaps and fill_contacts of kernels/contact/contact.cl):
// more than 64 work-groups, worlds without any pair, first pairs of worlds within and at the ends of work-groups.
#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "energies/contact/barrier.h"
#include "host/device/device.hpp"

namespace pvg {
namespace {

TEST(ContactList, HasTheActivePairsOfEachWorldInTheirOrder) {
  const std::vector<u32> pairs_of_world = {130, 0, 62, 5000, 1, 0, 743, 0};
  std::mt19937 random(3);
  std::vector<Barrier> pairs;
  std::vector<double> x;  // of each pair a point above the middle of its own triangle
  std::vector<u32> first_pair = {0}, first_expected = {0}, expected;
  for (u32 world = 0; world < pairs_of_world.size(); ++world) {
    for (u32 k = 0; k < pairs_of_world[world]; ++k) {
      const u32 i = u32(pairs.size()), site = 4 * i;
      // in places whole work-groups have none
      const bool is_near = i / 64 % 5 != 2 && random() % 3 == 0, exerts_force = random() % 7 != 0;
      Barrier pair{};
      for (u32 s = 0; s < 4; ++s) pair.site[s] = site + s;
      pair.kind = POINT_TRIANGLE;
      pair.world = world;
      pair.area = exerts_force ? 1e-6 : 0;
      pair.activation_distance = 1e-3;
      pairs.push_back(pair);
      for (const double value : {0.2, 0.2, is_near ? 5e-4 : 2e-3, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0})
        x.push_back(value);
      if (is_near && exerts_force) expected.push_back(i);
    }
    first_pair.push_back(u32(pairs.size()));
    first_expected.push_back(u32(expected.size()));
  }
  ASSERT_GT(pairs.size(), 64u * 64u);

  Device device;
  Program program(device, "contact/contact.cl");
  Kernel pair_gaps = program.kernel("pair_gaps"), fill_contacts = program.kernel("fill_contacts");
  const u32 n = u32(pairs.size()), n_worlds = u32(pairs_of_world.size());
  const Buffer<Barrier> rows(device, pairs, "pairs");
  const Buffer<f64> positions(device, x, "x");
  const Buffer<u32> first_of_world(device, first_pair, "first_pair");
  Buffer<f64> gap(device, n, "gap");
  Buffer<u32> is_active(device, n, "is_active"), counts(device, (n + 63) / 64, "counts");
  Buffer<u32> first(device, n_worlds + 1, "first"), sites(device, 4 * std::size_t(n), "sites"),
      changed(device, 1, "changed");
  Buffer<Barrier> contacts(device, n, "contacts");
  sites.zero();
  changed.zero();
  pair_gaps(n, n, rows, positions, gap, is_active, counts);
  for (const u32 search : {1u, 2u}) {
    fill_contacts(n, n, n_worlds, rows, is_active, counts, first_of_world, first, contacts, sites, search, changed);
    EXPECT_EQ(changed.read()[0], 1u) << "the second search finds the sites of the first";
  }
  EXPECT_EQ(first.read(), first_expected);
  const std::vector<Barrier> found = contacts.read();
  const std::vector<u32> found_sites = sites.read();
  for (std::size_t c = 0; c < expected.size(); ++c) {
    ASSERT_EQ(found[c].site[0], 4 * expected[c]) << "contact " << c;
    ASSERT_EQ(found[c].world, pairs[expected[c]].world) << "contact " << c;
    ASSERT_EQ(found_sites[4 * c + 3], 4 * expected[c] + 3) << "contact " << c;
  }
}

}  // namespace
}  // namespace pvg
