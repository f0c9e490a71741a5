#include "host/device/scan.hpp"

namespace pvg {
namespace {
constexpr std::size_t CHUNK = 64;  // as in shared/scan.cl
}

Scan::Scan(Device& device)
    : device_(&device),
      program_(device, "shared/scan.cl"),
      sums_(program_.kernel("scan_sums")),
      scan_few_(program_.kernel("scan_few")),
      spread_(program_.kernel("scan_spread")),
      pick_(program_.kernel("scan_pick")),
      picked_(device, 1, "scan_picked") {}

void Scan::operator()(std::size_t n, const Buffer<u32>& counts, Buffer<u32>& offsets) {
  if (counts.size() < n) detail::throw_size_mismatch(counts.name(), counts.size(), n);
  offsets.resize(n + 1);
  std::vector<std::size_t> size = {n};  // of each level
  while (size.back() > CHUNK) size.push_back((size.back() + CHUNK - 1) / CHUNK);
  const std::size_t n_above = size.size() - 1;
  while (sums_of_level_.size() < n_above) {
    sums_of_level_.emplace_back(*device_, 0, "scan_sums");
    offsets_of_level_.emplace_back(*device_, 0, "scan_offsets");
  }
  for (std::size_t level = 0; level < n_above; ++level) {
    sums_of_level_[level].resize(size[level + 1]);
    offsets_of_level_[level].resize(size[level + 1] + 1);
  }
  const auto counts_of = [&](std::size_t level) -> const Buffer<u32>& {
    return level == 0 ? counts : sums_of_level_[level - 1];
  };
  const auto offsets_of = [&](std::size_t level) -> Buffer<u32>& {
    return level == 0 ? offsets : offsets_of_level_[level - 1];
  };
  for (std::size_t level = 0; level < n_above; ++level)
    sums_(size[level + 1], u32(size[level + 1]), u32(size[level]), counts_of(level), sums_of_level_[level]);
  scan_few_(1, 1u, u32(size.back()), counts_of(n_above), offsets_of(n_above));
  for (std::size_t level = n_above; level-- > 0;)
    spread_(size[level + 1], u32(size[level + 1]), u32(size[level]), counts_of(level), offsets_of_level_[level],
            offsets_of(level));
}

std::vector<u32> Scan::read_at(const Buffer<u32>& offsets, const Buffer<u32>& places) {
  picked_.resize(places.size());
  pick(offsets, places, picked_);
  return picked_.read();
}

void Scan::pick(const Buffer<u32>& offsets, const Buffer<u32>& places, Buffer<u32>& picked) {
  pick_(places.size(), u32(places.size()), offsets, places, picked);
}

}  // namespace pvg
