// Sums and maxima per world: one work-group per world (solve/world_sum.cl), which large worlds leave their chunks to one
// work-item each before.
// In all kernels of worlds: n_items = 64 n_worlds;  has_partial: whether the chunks were taken before;  first: [n_worlds
// + 1] chunks of the worlds;  partial: [n_chunks];  out: [n_worlds]
#include "solve/late_sum.cl"
#include "solve/world_largest.cl"
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
  const uint w = get_group_id(0);
  start_late_sum(w, has_partial, first, chunks, a, partial, has_late, most, from, late_first, late_partial);
  barrier(CLK_GLOBAL_MEM_FENCE);
  if (get_local_id(0) > 0) return;
  out[w] = late_sum(w, first, partial, has_late, most, late_first, late_partial);
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
