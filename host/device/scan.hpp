// Exclusive prefix sum of u32 on the device, in a fixed order: where each element's own rows begin.
#pragma once
#include "host/device/device.hpp"
#include "shared/types.h"

namespace pvg {

class Scan {
 public:
  explicit Scan(Device& device);
  // offsets[i] = counts[0] + ... + counts[i-1] for i = 0 .. n, so offsets[n] is the sum. offsets is resized to n + 1.
  void operator()(std::size_t n, const Buffer<u32>& counts, Buffer<u32>& offsets);
  // offsets at the given places, on the host: one short blocking read. places: [n_places, < offsets.size()]
  std::vector<u32> read_at(const Buffer<u32>& offsets, const Buffer<u32>& places);

 private:
  Program program_;
  Kernel sums_, spread_, pick_;
  Buffer<u32> sums_of_chunks_, picked_;
};

}  // namespace pvg
