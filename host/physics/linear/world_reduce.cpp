#include "host/physics/linear/world_reduce.hpp"

#include <algorithm>

namespace pvg {

WorldChunks::WorldChunks(Device& device, std::size_t n_worlds, u32 length)
    : n_worlds_(n_worlds),
      length_(length),
      chunks_(device, 0, "chunks"),
      first_(device, n_worlds + 1, "first"),
      partial_(device, 0, "partial") {}

void WorldChunks::set(std::span<const WorldRange> ranges) {
  if (!ranges.empty() && std::equal(ranges.begin(), ranges.end(), ranges_.begin(), ranges_.end())) return;
  ranges_.assign(ranges.begin(), ranges.end());
  std::vector<std::vector<Chunk>> of_world(n_worlds_);
  for (const WorldRange& range : ranges)
    for (u32 begin = range.begin; begin < range.end; begin += length_)
      of_world[range.world].push_back({begin, std::min(begin + length_, range.end), range.world, 0});
  std::vector<Chunk> chunks;
  std::vector<u32> first = {0};
  most_ = 0;
  for (u32 w = 0; w < of_world.size(); ++w) {
    std::vector<Chunk>& own = of_world[w];
    if (own.empty()) own.push_back({0, 0, w, 0});
    most_ = std::max(most_, own.size());
    chunks.insert(chunks.end(), own.begin(), own.end());
    first.push_back(u32(chunks.size()));
  }
  n_chunks_ = chunks.size();
  chunks_.resize(n_chunks_);
  chunks_.write(chunks);
  partial_.resize(n_chunks_);
  first_.write(first);
}

WorldReduce::WorldReduce(Device& device, std::size_t n_worlds)
    : n_worlds_(n_worlds),
      program_(device, "solve/world_reduce.cl"),
      sum_chunks_(program_.kernel("sum_chunks")),
      largest_length_chunks_(program_.kernel("largest_length_chunks")),
      sum_worlds_(program_.kernel("sum_worlds")),
      largest_worlds_(program_.kernel("largest_worlds")),
      late_partial_(device, 0, "late_partial") {}

void WorldReduce::sum(const WorldChunks& c, const Buffer<f64>& a, bool has_late, u32 from,
                      const Buffer<u32>& late_first, u32 most, Buffer<f64>& out) {
  late_partial_.resize(n_worlds_ * most);
  start_chunks(c, a);
  sum_worlds_(n_items(), u32(n_items()), u32(c.has_large_world()), c.first_, c.chunks_, a, c.partial_, u32(has_late),
              most, from, late_first, late_partial_, out);
}

void WorldReduce::start_chunks(const WorldChunks& c, const Buffer<f64>& a) {
  if (c.has_large_world()) sum_chunks_(c.n_chunks_, u32(c.n_chunks_), c.chunks_, a, c.partial_);
}

Buffer<f64>& WorldReduce::late_partial(u32 most) {
  late_partial_.resize(n_worlds_ * n_late_chunks(most));
  return late_partial_;
}

void WorldReduce::sum(const WorldChunks& c, const Buffer<f64>& a, Buffer<f64>& out) {
  sum(c, a, false, 0, c.first_, 1, out);
}

void WorldReduce::sum(const WorldChunks& c, const Buffer<f64>& a, u32 from, const Buffer<u32>& late_first, u32 most,
                      Buffer<f64>& out) {
  sum(c, a, true, from, late_first, n_late_chunks(most), out);
}

void WorldReduce::largest_length(const WorldChunks& c, const Buffer<Site>& sites, const Buffer<f64>& a,
                                 Buffer<f64>& out) {
  if (c.has_large_world()) largest_length_chunks_(c.n_chunks_, u32(c.n_chunks_), c.chunks_, sites, a, c.partial_);
  largest_worlds_(n_items(), u32(n_items()), u32(c.has_large_world()), c.first_, c.chunks_, sites, a, c.partial_, out);
}

}  // namespace pvg
