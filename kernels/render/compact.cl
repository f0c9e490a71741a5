// The live paths of the next bounce, in order: count per piece of 64, scan the counts, fill.
#define PIECE 64u

// alive: [n] 0 or 1;  counts: [pieces]
kernel void count_alive(const uint n_pieces, const uint n, global const uint* restrict alive,
                        global uint* restrict counts) {
  const uint piece = get_global_id(0);
  if (piece >= n_pieces) return;
  uint sum = 0;
  for (uint i = piece * PIECE; i < min(n, (piece + 1) * PIECE); ++i) sum += alive[i];
  counts[piece] = sum;
}

// one work-item: counts become first places, total[0] their sum. A few thousand additions
kernel void scan_counts(const uint n_pieces, global uint* restrict counts, global uint* restrict total) {
  if (get_global_id(0) > 0) return;
  uint sum = 0;
  for (uint piece = 0; piece < n_pieces; ++piece) {
    const uint count = counts[piece];
    counts[piece] = sum;
    sum += count;
  }
  total[0] = sum;
}

// next: [total] slots that live on
kernel void fill_queue(const uint n_pieces, const uint n, global const uint* restrict alive,
                       global const uint* restrict counts, global const uint* restrict queue,
                       global uint* restrict next) {
  const uint piece = get_global_id(0);
  if (piece >= n_pieces) return;
  uint place = counts[piece];
  for (uint i = piece * PIECE; i < min(n, (piece + 1) * PIECE); ++i)
    if (alive[i]) next[place++] = queue[i];
}
