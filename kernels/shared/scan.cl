// Exclusive prefix sum of u32. A work-item takes `width` neighbours, so few counts take one work-group and one launch. Of
// many the chunks of CHUNK are summed in a launch before, and each work-group begins with what the groups before it hold.
#include "shared/types.h"
#define CHUNK 64u
#define ITEMS 64u

// sums[c] = sum of counts[c CHUNK .. (c+1) CHUNK)
kernel void scan_sums(const uint n_chunks, const uint n, global const u32* restrict counts, global u32* restrict sums) {
  const uint c = get_global_id(0);
  if (c >= n_chunks) return;
  const uint end = min(n, (c + 1) * CHUNK);
  u32 sum = 0;
  for (uint i = c * CHUNK; i < end; ++i) sum += counts[i];
  sums[c] = sum;
}

// n_items: at least n / width;  width: CHUNK where there is more than one work-group
// sums: [n / CHUNK, rounded up], read where there is;  offsets: [n + 1]
kernel __attribute__((reqd_work_group_size(ITEMS, 1, 1))) void scan_spread(const uint n_items, const uint n,
                                                                           const uint width,
                                                                           global const u32* restrict counts,
                                                                           global const u32* restrict sums,
                                                                           global u32* restrict offsets) {
  local u32 before_group[ITEMS], of_item[ITEMS];
  const uint item = get_local_id(0), i = get_global_id(0), first_chunk = get_group_id(0) * ITEMS;
  const uint begin = min(n, i * width), end = min(n, begin + width);
  u32 sum = 0;
  for (uint c = item; c < first_chunk; c += ITEMS) sum += sums[c];
  before_group[item] = sum;
  sum = 0;
  for (uint k = begin; k < end; ++k) sum += counts[k];
  of_item[item] = sum;
  barrier(CLK_LOCAL_MEM_FENCE);
  sum = 0;
  for (uint k = 0; k < ITEMS; ++k) sum += before_group[k];
  for (uint k = 0; k < item; ++k) sum += of_item[k];
  for (uint k = begin; k < end; ++k) {
    offsets[k] = sum;
    sum += counts[k];
  }
  if (end == n && (begin < end || i == 0)) offsets[n] = sum;
}

// picked[i] = values[places[i]]
kernel void scan_pick(const uint n, global const u32* restrict values, global const u32* restrict places,
                      global u32* restrict picked) {
  const uint i = get_global_id(0);
  if (i >= n) return;
  picked[i] = values[places[i]];
}
