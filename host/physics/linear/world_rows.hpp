// Rows of all worlds in one buffer of the device, sorted by world.
#pragma once
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

}  // namespace pvg
