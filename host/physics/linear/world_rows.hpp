// Rows of all worlds in one buffer of the device, sorted by world.
#pragma once
#include <array>
#include <span>
#include <vector>

#include "host/device/device.hpp"
#include "shared/types.h"

namespace pvg {

template <class Row>
struct WorldRows {
  Buffer<Row> rows;        // [n]
  std::vector<u32> first;  // [n_worlds + 1]: rows of world w are first[w] .. first[w+1] - 1
  u32 n() const { return first.back(); }
};

// What lies in the wanted worlds, in as few pieces [begin, end) as they make.  first: [n_worlds + 1] of each world;
// is_wanted: [n_worlds], or empty, then all are
inline std::vector<std::array<u32, 2>> pieces_of(std::span<const u32> first, std::span<const char> is_wanted) {
  if (is_wanted.empty()) return {{first.front(), first.back()}};
  std::vector<std::array<u32, 2>> pieces;
  for (std::size_t w = 0; w < is_wanted.size(); ++w) {
    if (!is_wanted[w] || first[w] == first[w + 1]) continue;
    if (pieces.empty() || pieces.back()[1] != first[w]) pieces.push_back({first[w], first[w]});
    pieces.back()[1] = first[w + 1];
  }
  return pieces;
}

}  // namespace pvg
