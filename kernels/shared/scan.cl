// Exclusive prefix sum of u32: each work-item sums CHUNK neighbours, the sums are scanned the same way (the host calls
// the kernels level by level), then each work-item spreads its offset over its chunk. No barriers, one fixed order.
#include "shared/types.h"
#define CHUNK 64u

// sums[c] = sum of counts[c CHUNK .. (c+1) CHUNK)
kernel void scan_sums(const uint n_chunks, const uint n, global const u32* restrict counts, global u32* restrict sums) {
  const uint c = get_global_id(0);
  if (c >= n_chunks) return;
  const uint end = min(n, (c + 1) * CHUNK);
  u32 sum = 0;
  for (uint i = c * CHUNK; i < end; ++i) sum += counts[i];
  sums[c] = sum;
}

// one work-item, n <= CHUNK. offsets: [n + 1]
kernel void scan_few(const uint n_items, const uint n, global const u32* restrict counts,
                     global u32* restrict offsets) {
  if (get_global_id(0) >= n_items) return;
  u32 sum = 0;
  for (uint i = 0; i < n; ++i) {
    offsets[i] = sum;
    sum += counts[i];
  }
  offsets[n] = sum;
}

// chunk_offsets: [n_chunks + 1];  offsets: [n + 1]
kernel void scan_spread(const uint n_chunks, const uint n, global const u32* restrict counts,
                        global const u32* restrict chunk_offsets, global u32* restrict offsets) {
  const uint c = get_global_id(0);
  if (c >= n_chunks) return;
  const uint end = min(n, (c + 1) * CHUNK);
  u32 sum = chunk_offsets[c];
  for (uint i = c * CHUNK; i < end; ++i) {
    offsets[i] = sum;
    sum += counts[i];
  }
  if (end == n) offsets[n] = sum;
}

// picked[i] = values[places[i]]
kernel void scan_pick(const uint n, global const u32* restrict values, global const u32* restrict places,
                      global u32* restrict picked) {
  const uint i = get_global_id(0);
  if (i >= n) return;
  picked[i] = values[places[i]];
}
