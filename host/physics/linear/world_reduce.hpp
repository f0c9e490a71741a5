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
  static constexpr u32 LENGTH = 128;  // as in solve/world_reduce.cl
  // length: most elements of a chunk
  WorldChunks(Device& device, std::size_t n_worlds, u32 length = LENGTH);
  // ranges in any number per world; the order of a world's ranges is the order of its sum
  void set(std::span<const WorldRange> ranges);
  std::size_t n_chunks() const { return n_chunks_; }       // at least one for each world
  const Buffer<Chunk>& chunks() const { return chunks_; }  // [n_chunks]
  const Buffer<u32>& first() const { return first_; }      // [n_worlds + 1] chunks of each world
  Buffer<f64>& partial() const { return partial_; }        // [n_chunks] of the last reduction
  std::size_t most() const { return most_; }               // chunks of one world
  // Whether a world has so many chunks that they are worth a launch of their own, before that of the worlds.
  bool has_large_world() const { return most_ > MOST_IN_ONE_GROUP; }

 private:
  friend class WorldReduce;
  static constexpr std::size_t MOST_IN_ONE_GROUP = 128;  // two rounds of 64 work-items
  std::size_t n_worlds_, n_chunks_ = 0, most_ = 0;       // most_: chunks of one world
  u32 length_;
  std::vector<WorldRange> ranges_;
  Buffer<Chunk> chunks_;
  Buffer<u32> first_;
  mutable Buffer<f64> partial_;
};

class WorldReduce {
 public:
  WorldReduce(Device& device, std::size_t n_worlds);
  // out[w] = sum of a;  a: [n_elements], out: [n_worlds]
  void sum(const WorldChunks& chunks, const Buffer<f64>& a, Buffer<f64>& out);
  // The same over a's first elements, in chunks, then over elements of which the host does not know how many there are:
  // late_first [n_worlds + 1], on the device, counted from element `from`; most: that there may be
  void sum(const WorldChunks& chunks, const Buffer<f64>& a, u32 from, const Buffer<u32>& late_first, u32 most,
           Buffer<f64>& out);
  // What sum() of the second kind needs before its last launch, where that is another one's (contact/sum_and_list.cl):
  // sums of the chunks of large worlds; room for those of late elements, n_late_chunks(most) in each world.
  void start_chunks(const WorldChunks& chunks, const Buffer<f64>& a);
  Buffer<f64>& late_partial(u32 most);
  static u32 n_late_chunks(u32 most) { return most / WorldChunks::LENGTH + 1; }
  // out[w] = largest length at the sites in the chunks;  a: [n_nodes x 3]
  void largest_length(const WorldChunks& chunks, const Buffer<Site>& sites, const Buffer<f64>& a, Buffer<f64>& out);

 private:
  std::size_t n_items() const { return GROUP_SIZE * n_worlds_; }
  void sum(const WorldChunks& chunks, const Buffer<f64>& a, bool has_late, u32 from, const Buffer<u32>& late_first,
           u32 most, Buffer<f64>& out);

  std::size_t n_worlds_;
  Program program_;
  Kernel sum_chunks_, largest_length_chunks_, sum_worlds_, largest_worlds_;
  Buffer<f64> late_partial_;  // [n_worlds x most chunks]
};

}  // namespace pvg
