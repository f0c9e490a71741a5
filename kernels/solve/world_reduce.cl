// Sums and maxima per world in a fixed order: one work-item per chunk of consecutive elements, then one per world over
// its chunks. Chunks begin at each world's first element, so a world's bits do not depend on its companions.
#include "shared/real.h"
#include "solve/site.h"
#define CHUNK_LENGTH 128u

// partial[c] = sum of a . b over the chunk;  a, b: [n_elements x 3]
kernel void dot_chunks(const uint n, global const Chunk* restrict chunks, global const real* restrict a,
                       global const real* restrict b, global real* restrict partial) {
  const uint c = get_global_id(0);
  if (c >= n) return;
  real sum = 0;
  for (uint i = chunks[c].begin; i < chunks[c].end; ++i) sum += dot(vload3(i, a), vload3(i, b));
  partial[c] = sum;
}

// partial[c] = sum of a over the chunk;  a: [n_elements]
kernel void sum_chunks(const uint n, global const Chunk* restrict chunks, global const real* restrict a,
                       global real* restrict partial) {
  const uint c = get_global_id(0);
  if (c >= n) return;
  real sum = 0;
  for (uint i = chunks[c].begin; i < chunks[c].end; ++i) sum += a[i];
  partial[c] = sum;
}

// partial[c] = largest |a| over the chunk, infinite where a is not a number;  a: [n_elements x 3]
kernel void largest_length_chunks(const uint n, global const Chunk* restrict chunks, global const real* restrict a,
                                  global real* restrict partial) {
  const uint c = get_global_id(0);
  if (c >= n) return;
  real largest = 0;
  for (uint i = chunks[c].begin; i < chunks[c].end; ++i) {
    const real l = length(vload3(i, a));
    largest = l <= largest ? largest : (isnan(l) ? INFINITY : l);
  }
  partial[c] = largest;
}

// out[w] = sum of the world's partials;  first: [n + 1] chunk offsets of the worlds
kernel void sum_worlds(const uint n, global const uint* restrict first, global const real* restrict partial,
                       global real* restrict out) {
  const uint w = get_global_id(0);
  if (w >= n) return;
  real sum = 0;
  for (uint c = first[w]; c < first[w + 1]; ++c) sum += partial[c];
  out[w] = sum;
}

// Elements of which only the device knows how many each world has: first[w] to first[w + 1], counted from element `from`.
// n: worlds x most, the most chunks that a world may have;  late_partial: [n]
kernel void sum_late_chunks(const uint n, const uint most, const uint from, global const uint* restrict late_first,
                            global const real* restrict a, global real* restrict late_partial) {
  const uint i = get_global_id(0);
  if (i >= n) return;
  const uint w = i / most, begin = late_first[w] + i % most * CHUNK_LENGTH;
  const uint end = min(late_first[w + 1], begin + CHUNK_LENGTH);
  real sum = 0;
  for (uint e = begin; e < end; ++e) sum += a[from + e];
  late_partial[i] = sum;
}

// out[w] = sum of the world's partials, then of its late ones
kernel void sum_worlds_and_late(const uint n, global const uint* restrict first, global const real* restrict partial,
                                const uint most, global const uint* restrict late_first,
                                global const real* restrict late_partial, global real* restrict out) {
  const uint w = get_global_id(0);
  if (w >= n) return;
  real sum = 0;
  for (uint c = first[w]; c < first[w + 1]; ++c) sum += partial[c];
  for (uint c = 0; c * CHUNK_LENGTH < late_first[w + 1] - late_first[w]; ++c) sum += late_partial[w * most + c];
  out[w] = sum;
}

kernel void largest_worlds(const uint n, global const uint* restrict first, global const real* restrict partial,
                           global real* restrict out) {
  const uint w = get_global_id(0);
  if (w >= n) return;
  real largest = 0;
  for (uint c = first[w]; c < first[w + 1]; ++c) largest = max(largest, partial[c]);
  out[w] = largest;
}
