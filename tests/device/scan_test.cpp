// The prefix sum against a plain loop.
#include "host/device/scan.hpp"

#include <gtest/gtest.h>

#include <random>

namespace pvg {
namespace {

TEST(Scan, EqualsThePlainLoop) {
  Device device;
  Scan scan(device);
  std::mt19937 random(7);
  // large after small and small after large: the buffers of the levels are reused
  for (const std::size_t n : {0, 1, 3, 257, 1000, 100000, 64, 65, 4096, 4097, 16384, 16385, 3}) {
    std::vector<u32> counts(n);
    for (u32& count : counts) count = random() % 5;
    const Buffer<u32> on_device(device, counts, "counts");
    Buffer<u32> offsets(device, 0, "offsets");
    scan(n, on_device, offsets);
    const std::vector<u32> found = offsets.read();
    ASSERT_EQ(found.size(), n + 1);
    u32 sum = 0;
    for (std::size_t i = 0; i < n; ++i) {
      ASSERT_EQ(found[i], sum) << i << " of " << n;
      sum += counts[i];
    }
    ASSERT_EQ(found[n], sum);
    const Buffer<u32> places(device, std::vector<u32>{u32(n), 0, u32(n / 2)}, "places");
    EXPECT_EQ(scan.read_at(offsets, places), (std::vector<u32>{found[n], found[0], found[n / 2]}));
  }
}

}  // namespace
}  // namespace pvg
