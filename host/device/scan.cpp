#include "host/device/scan.hpp"

#include <algorithm>

namespace pvg {
namespace {
constexpr std::size_t CHUNK = 64;             // as in shared/scan.cl
constexpr std::size_t MOST_IN_ONE = 1 << 14;  // counts that one work-group scans alone, by judgement, not measured
}  // namespace

Scan::Scan(Device& device)
    : program_(device, "shared/scan.cl"),
      sums_(program_.kernel("scan_sums")),
      spread_(program_.kernel("scan_spread")),
      pick_(program_.kernel("scan_pick")),
      sums_of_chunks_(device, 0, "sums"),
      picked_(device, 1, "scan_picked") {}

void Scan::operator()(std::size_t n, const Buffer<u32>& counts, Buffer<u32>& offsets) {
  if (counts.size() < n) detail::throw_size_mismatch(counts.name(), counts.size(), n);
  offsets.resize(n + 1);
  if (n <= MOST_IN_ONE) {
    const std::size_t width = std::max<std::size_t>(1, (n + GROUP_SIZE - 1) / GROUP_SIZE);
    spread_(GROUP_SIZE, u32(GROUP_SIZE), u32(n), u32(width), counts, sums_of_chunks_, offsets);
    return;
  }
  const std::size_t n_chunks = (n + CHUNK - 1) / CHUNK;
  sums_of_chunks_.resize(n_chunks);
  sums_(n_chunks, u32(n_chunks), u32(n), counts, sums_of_chunks_);
  spread_(n_chunks, u32(n_chunks), u32(n), u32(CHUNK), counts, sums_of_chunks_, offsets);
}

std::vector<u32> Scan::read_at(const Buffer<u32>& offsets, const Buffer<u32>& places) {
  picked_.resize(places.size());
  pick_(places.size(), u32(places.size()), offsets, places, picked_);
  return picked_.read();
}

}  // namespace pvg
