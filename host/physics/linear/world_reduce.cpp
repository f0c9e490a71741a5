#include "host/physics/linear/world_reduce.hpp"

#include <algorithm>

namespace pvg {

constexpr u32 CHUNK_LENGTH = 128;  // as in solve/world_reduce.cl

WorldChunks::WorldChunks(Device& device, std::size_t n_worlds)
    : n_worlds_(n_worlds),
      chunks_(device, 0, "chunks"),
      first_(device, n_worlds + 1, "first"),
      partial_(device, 0, "partial") {}

void WorldChunks::set(std::span<const WorldRange> ranges) {
  if (!ranges.empty() && std::equal(ranges.begin(), ranges.end(), ranges_.begin(), ranges_.end())) return;
  ranges_.assign(ranges.begin(), ranges.end());
  std::vector<std::vector<Chunk>> of_world(n_worlds_);
  for (const WorldRange& range : ranges)
    for (u32 begin = range.begin; begin < range.end; begin += CHUNK_LENGTH)
      of_world[range.world].push_back({begin, std::min(begin + CHUNK_LENGTH, range.end), range.world, 0});
  std::vector<Chunk> chunks;
  std::vector<u32> first = {0};
  for (const auto& own : of_world) {
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
      dot_chunks_(program_.kernel("dot_chunks")),
      sum_chunks_(program_.kernel("sum_chunks")),
      sum_late_chunks_(program_.kernel("sum_late_chunks")),
      largest_length_chunks_(program_.kernel("largest_length_chunks")),
      sum_worlds_(program_.kernel("sum_worlds")),
      sum_worlds_and_late_(program_.kernel("sum_worlds_and_late")),
      largest_worlds_(program_.kernel("largest_worlds")),
      late_partial_(device, 0, "late_partial") {}

void WorldReduce::dot(const WorldChunks& c, const Buffer<f64>& a, const Buffer<f64>& b, Buffer<f64>& out) {
  dot_chunks(c, a, b);
  sum_worlds_(n_worlds_, u32(n_worlds_), c.first_, c.partial_, out);
}

void WorldReduce::dot_chunks(const WorldChunks& c, const Buffer<f64>& a, const Buffer<f64>& b) {
  dot_chunks_(c.n_chunks_, u32(c.n_chunks_), c.chunks_, a, b, c.partial_);
}

void WorldReduce::sum(const WorldChunks& c, const Buffer<f64>& a, Buffer<f64>& out) {
  sum_chunks_(c.n_chunks_, u32(c.n_chunks_), c.chunks_, a, c.partial_);
  sum_worlds_(n_worlds_, u32(n_worlds_), c.first_, c.partial_, out);
}

void WorldReduce::sum(const WorldChunks& c, const Buffer<f64>& a, u32 from, const Buffer<u32>& late_first, u32 most,
                      Buffer<f64>& out) {
  const u32 n_worlds = u32(n_worlds_), most_chunks = most / CHUNK_LENGTH + 1, n = n_worlds * most_chunks;
  late_partial_.resize(n);
  sum_chunks_(c.n_chunks_, u32(c.n_chunks_), c.chunks_, a, c.partial_);
  sum_late_chunks_(n, n, most_chunks, from, late_first, a, late_partial_);
  sum_worlds_and_late_(n_worlds, n_worlds, c.first_, c.partial_, most_chunks, late_first, late_partial_, out);
}

void WorldReduce::largest_length(const WorldChunks& c, const Buffer<f64>& a, Buffer<f64>& out) {
  largest_length_chunks_(c.n_chunks_, u32(c.n_chunks_), c.chunks_, a, c.partial_);
  largest_worlds_(n_worlds_, u32(n_worlds_), c.first_, c.partial_, out);
}

}  // namespace pvg
