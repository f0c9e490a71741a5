// Lists of the rows that each node sums: those that the device makes are those that the host makes.
#include "host/physics/linear/gather.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <span>

namespace pvg {
namespace {

constexpr u32 SITES = 4;  // of an element

// Worlds of nodes, each carrying sites: a node alone, or four nodes of which one may have no weight.
struct Worlds {
  Worlds(const std::vector<u32>& n_nodes, unsigned seed) : random(seed) {
    for (u32 w = 0; w < n_nodes.size(); ++w) {
      ranges.push_back({w, n, n + n_nodes[w]});
      first_site.push_back(u32(sites.size()));
      for (u32 i = n; i < n + n_nodes[w]; ++i) sites.push_back({{i, 0, 0, 0}, {1, 0, 0, 0}});
      for (u32 k = 0; k < n_nodes[w] / 2; ++k) {
        Site site{};
        for (int j = 0; j < 4; ++j) {
          site.node[j] = n + random() % n_nodes[w];
          site.weight[j] = j == 2 ? 0 : 0.25 * double(1 + random() % 7);
        }
        sites.push_back(site);
      }
      n += n_nodes[w];
    }
    first_site.push_back(u32(sites.size()));
  }
  // of each world so many elements; the sites of all of them
  std::vector<u32> elements(const std::vector<u32>& n_elements) {
    std::vector<u32> of_elements;
    for (u32 w = 0; w < n_elements.size(); ++w)
      for (u32 k = 0; k < SITES * n_elements[w]; ++k)
        of_elements.push_back(first_site[w] + u32(random() % (first_site[w + 1] - first_site[w])));
    return of_elements;
  }
  std::mt19937 random;
  u32 n = 0;
  std::vector<WorldRange> ranges;
  std::vector<u32> first_site;
  std::vector<Site> sites;
};

std::vector<u32> first_of(const std::vector<u32>& counts) {
  std::vector<u32> first = {0};
  for (const u32 count : counts) first.push_back(first.back() + count);
  return first;
}

// more_room: for elements of the first kind, than there are of them; what has no room is left out
void expect_same_lists(const std::vector<u32>& n_nodes, const std::vector<u32>& n_first,
                       const std::vector<u32>& n_second, int more_room = 0) {
  constexpr u32 FIRST_ROW = 17;
  Device device;
  Worlds worlds(n_nodes, 5);
  const std::vector<u32> first = worlds.elements(n_first), second = worlds.elements(n_second);
  Gather on_host(device, worlds.sites, worlds.n), on_device(device, worlds.sites, worlds.n);
  const u32 room = u32(int(first.size() / SITES) + more_room), n_found = std::min(room, u32(first.size() / SITES));
  const RowBlock blocks[] = {{std::span(first).first(SITES * n_found), FIRST_ROW}, {second, FIRST_ROW + SITES * room}};
  on_host.set(blocks);
  const Buffer<u32> first_sites(device, first, "first sites"), second_sites(device, second, "second sites"),
      first_of_first(device, first_of(n_first), "first"), first_of_second(device, first_of(n_second), "second");
  const Buffer<Site> sites(device, worlds.sites, "sites");
  Buffer<u32> element_sites(device, 0, "element_sites");
  WorldChunks chunks(device, n_nodes.size(), GROUP_SIZE);
  chunks.set(worlds.ranges);
  on_device.set_on_device({first_sites, room, first_of_first},
                          {second_sites, u32(second.size() / SITES), first_of_second}, FIRST_ROW, sites, chunks,
                          element_sites);
  std::vector<u32> all(first.begin(), first.begin() + SITES * n_found);
  for (u32 e = n_found; e < room; ++e)  // the last one's, so that worlds ascend
    for (u32 k = 0; k < SITES; ++k) all.push_back(n_found > 0 ? first[SITES * (n_found - 1) + k] : 0);
  all.insert(all.end(), second.begin(), second.end());
  EXPECT_EQ(element_sites.read(), all);
  ASSERT_EQ(on_device.offset().read(), on_host.offset().read());
  const std::size_t n_entries = on_host.row().size();
  EXPECT_EQ(on_device.row().read(0, n_entries), on_host.row().read());
  EXPECT_EQ(on_device.weight().read(0, n_entries), on_host.weight().read());
}

TEST(Gather, TheDevicesListsAreThoseOfTheHost) {
  expect_same_lists({200}, {90}, {33});
  expect_same_lists({64, 3, 129}, {40, 0, 70}, {16, 5, 0});
}

TEST(Gather, WithoutElementsOfAKindListsAreRight) {
  expect_same_lists({70, 10}, {0, 0}, {20, 3});
  expect_same_lists({70, 10}, {20, 3}, {0, 0});
}

TEST(Gather, OfTheFirstKindThereMayBeFewerElementsThanRoomOrMore) {
  expect_same_lists({64, 3, 129}, {40, 0, 70}, {16, 5, 0}, 33);
  expect_same_lists({70, 10}, {0, 0}, {20, 3}, 16);
  expect_same_lists({64, 3, 129}, {40, 0, 70}, {16, 5, 0}, -90);
}

// The longest of these lists are shared by a work-group's 64 work-items, as on devices whose work-items run side by
// side.
TEST(Gather, ListsThatAWorkGroupSharesAreSummedWhole) {
  constexpr u32 N = 130, N_ROWS = 500;
  Device device;
  Program program(device, "solve/nodes.cl", "-DLONGEST_OWN_LIST=3u");
  Kernel gather_rows = program.kernel("gather_rows");
  std::mt19937 random(3);
  std::uniform_real_distribution<double> number(-1, 1);
  std::vector<u32> offset = {0}, row, is_fixed(N, 0);
  std::vector<double> weight, rows, before, expected;
  for (u32 i = 0; i < 3 * N_ROWS; ++i) rows.push_back(number(random));
  for (u32 i = 0; i < 3 * N; ++i) before.push_back(number(random));
  expected = before;
  is_fixed[64] = 1;
  for (u32 i = 0; i < N; ++i) {
    // nodes 0, 5, 64 (which is fixed) and 129 have long lists, as have both ends of a work-group's nodes
    const u32 n = i == 0 ? 1000 : i == 5 ? 65 : i == 64 || i == 129 ? 64 : i == 63 ? 4 : i % 4;
    for (u32 k = 0; k < n; ++k) {
      row.push_back(random() % N_ROWS);
      weight.push_back(number(random));
      for (u32 c = 0; c < 3 && !is_fixed[i]; ++c) expected[3 * i + c] += weight.back() * rows[3 * row.back() + c];
    }
    offset.push_back(u32(row.size()));
  }
  Buffer<f64> node(device, before, "node");
  gather_rows(N, N, Buffer<u32>(device, offset, "offset"), Buffer<u32>(device, row, "row"),
              Buffer<f64>(device, weight, "weight"), Buffer<u32>(device, is_fixed, "is_fixed"),
              Buffer<f64>(device, rows, "rows"), 1u, node);
  const std::vector<double> found = node.read();
  for (u32 i = 0; i < 3 * N; ++i) EXPECT_NEAR(found[i], expected[i], 1e-13) << "node " << i / 3;
}

}  // namespace
}  // namespace pvg
