// Sums and maxima per world: one work-group per world (solve/world_sum.cl), which large worlds leave their chunks to one
// work-item each before.
// In all kernels of worlds: n_items = 64 n_worlds;  has_partial: whether the chunks were taken before;  first: [n_worlds
// + 1] chunks of the worlds;  partial: [n_chunks];  out: [n_worlds]
#include "solve/value_at_site.cl"
#include "solve/world_sum.cl"
#define CHUNK_LENGTH 128u
#define ONE_GROUP_PER_WORLD __attribute__((reqd_work_group_size(ITEMS, 1, 1)))

// partial[c] = sum of a over the chunk;  a: [n_elements]
kernel void sum_chunks(const uint n, global const Chunk* restrict chunks, global const real* restrict a,
                       global real* restrict partial) {
  const uint c = get_global_id(0);
  if (c < n) partial[c] = sum_of(chunks[c].begin, chunks[c].end, a);
}

// out[w] = the sum of a over the world's chunks, then over elements of which only the device knows how many each world
// has: late_first[w] to late_first[w + 1], counted from element `from`, if has_late
// late_partial: [n_worlds x most], the most chunks of these that a world may have
kernel ONE_GROUP_PER_WORLD void sum_worlds(const uint n_items, const uint has_partial,
                                           global const uint* restrict first, global const Chunk* restrict chunks,
                                           global const real* restrict a, global real* partial, const uint has_late,
                                           const uint most, const uint from, global const uint* restrict late_first,
                                           global real* late_partial, global real* restrict out) {
  const uint w = get_group_id(0), item = get_local_id(0), begin = first[w], end = first[w + 1];
  for (uint c = has_partial ? end : begin + item; c < end; c += ITEMS)
    partial[c] = sum_of(chunks[c].begin, chunks[c].end, a);
  const uint late_begin = has_late ? late_first[w] : 0, late_end = has_late ? late_first[w + 1] : 0;
  const uint n_late = (late_end - late_begin + CHUNK_LENGTH - 1) / CHUNK_LENGTH;
  for (uint c = item; c < n_late; c += ITEMS) {
    const uint chunk = late_begin + c * CHUNK_LENGTH;
    late_partial[w * most + c] = sum_of(from + chunk, from + min(late_end, chunk + CHUNK_LENGTH), a);
  }
  barrier(CLK_GLOBAL_MEM_FENCE);
  if (item > 0) return;
  out[w] = add_up(sum_of(begin, end, partial), w * most, w * most + n_late, late_partial);
}

// the larger of two lengths; a length that is not a number is infinite
static inline real larger(const real largest, const real length) {
  return length <= largest ? largest : (isnan(length) ? INFINITY : length);
}

// largest |a| over the chunk's sites from its first one on, each `stride`-th;  a: [n_nodes x 3]
static inline real largest_of_chunk(const Chunk chunk, const uint first, const uint stride,
                                    global const Site* restrict sites, global const real* restrict a) {
  real largest = 0;
  for (uint i = chunk.begin + first; i < chunk.end; i += stride)
    largest = larger(largest, length(value_at_site(sites + i, a)));
  return largest;
}

kernel void largest_length_chunks(const uint n, global const Chunk* restrict chunks, global const Site* restrict sites,
                                  global const real* restrict a, global real* restrict partial) {
  const uint c = get_global_id(0);
  if (c < n) partial[c] = largest_of_chunk(chunks[c], 0, 1, sites, a);
}

// The largest of numbers is the same in any order, so here each chunk is all work-items'.
kernel ONE_GROUP_PER_WORLD void largest_worlds(const uint n_items, const uint has_partial,
                                               global const uint* restrict first, global const Chunk* restrict chunks,
                                               global const Site* restrict sites, global const real* restrict a,
                                               global const real* restrict partial, global real* restrict out) {
  local real of_item[ITEMS];
  const uint w = get_group_id(0), item = get_local_id(0), begin = first[w], end = first[w + 1];
  real largest = 0;
  for (uint c = begin + item; c < (has_partial ? end : begin); c += ITEMS) largest = max(largest, partial[c]);
  for (uint c = has_partial ? end : begin; c < end; ++c)
    largest = max(largest, largest_of_chunk(chunks[c], item, ITEMS, sites, a));
  of_item[item] = largest;
  barrier(CLK_LOCAL_MEM_FENCE);
  if (item > 0) return;
  for (uint k = 1; k < ITEMS; ++k) largest = max(largest, of_item[k]);
  out[w] = largest;
}
