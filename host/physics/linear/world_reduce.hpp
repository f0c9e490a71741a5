// Sums and maxima per world, in a fixed order, on the device.
#pragma once
#include <span>
#include <vector>

#include "host/device/device.hpp"
#include "solve/site.h"

namespace pvg {

// Consecutive elements of one world: [begin, end).
struct WorldRange {
  u32 world, begin, end;
  bool operator==(const WorldRange&) const = default;
};

// The chunks into which the elements of a list are cut, and a buffer for their partial results.
class WorldChunks {
 public:
  WorldChunks(Device& device, std::size_t n_worlds);
  // ranges in any number per world; the order of a world's ranges is the order of its sum
  void set(std::span<const WorldRange> ranges);

 private:
  friend class WorldReduce;
  std::size_t n_worlds_, n_chunks_ = 0;
  std::vector<WorldRange> ranges_;
  Buffer<Chunk> chunks_;
  Buffer<u32> first_;
  mutable Buffer<f64> partial_;
};

class WorldReduce {
 public:
  WorldReduce(Device& device, std::size_t n_worlds);
  // out[w] = sum over the world's elements of a . b;  a, b: [n_elements x 3], out: [n_worlds]
  void dot(const WorldChunks& chunks, const Buffer<f64>& a, const Buffer<f64>& b, Buffer<f64>& out);
  // out[w] = sum of a;  a: [n_elements]
  void sum(const WorldChunks& chunks, const Buffer<f64>& a, Buffer<f64>& out);
  // out[w] = largest length;  a: [n_elements x 3]
  void largest_length(const WorldChunks& chunks, const Buffer<f64>& a, Buffer<f64>& out);

 private:
  std::size_t n_worlds_;
  Program program_;
  Kernel dot_chunks_, sum_chunks_, largest_length_chunks_, sum_worlds_, largest_worlds_;
};

}  // namespace pvg
