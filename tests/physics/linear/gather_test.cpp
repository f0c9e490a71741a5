// Lists of the rows that each node sums: those that the device makes are those that the host makes.
#include "host/physics/linear/gather.hpp"

#include <gtest/gtest.h>

#include <random>

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

void expect_same_lists(const std::vector<u32>& n_nodes, const std::vector<u32>& n_first,
                       const std::vector<u32>& n_second) {
  constexpr u32 FIRST_ROW = 17;
  Device device;
  Worlds worlds(n_nodes, 5);
  const std::vector<u32> first = worlds.elements(n_first), second = worlds.elements(n_second);
  Gather on_host(device, worlds.sites, worlds.n), on_device(device, worlds.sites, worlds.n);
  const RowBlock blocks[] = {{first, FIRST_ROW}, {second, FIRST_ROW + u32(first.size())}};
  on_host.set(blocks);
  const Buffer<u32> first_sites(device, first, "first sites"), second_sites(device, second, "second sites"),
      first_of_first(device, first_of(n_first), "first"), first_of_second(device, first_of(n_second), "second");
  const Buffer<Site> sites(device, worlds.sites, "sites");
  Buffer<u32> element_sites(device, 0, "element_sites");
  WorldChunks chunks(device, n_nodes.size(), GROUP_SIZE);
  chunks.set(worlds.ranges);
  on_device.set_on_device({first_sites, u32(first.size() / SITES), first_of_first},
                          {second_sites, u32(second.size() / SITES), first_of_second}, FIRST_ROW, sites, chunks,
                          element_sites);
  std::vector<u32> all = first;
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

}  // namespace
}  // namespace pvg
