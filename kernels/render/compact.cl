// The live paths of the next bounce, in order: count per piece of 64, scan the counts (shared/scan.cl), fill.
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

// offsets: [pieces + 1] of the counts;  next: slots that live on
kernel void fill_queue(const uint n_pieces, const uint n, global const uint* restrict alive,
                       global const uint* restrict offsets, global const uint* restrict queue,
                       global uint* restrict next) {
  const uint piece = get_global_id(0);
  if (piece >= n_pieces) return;
  uint place = offsets[piece];
  for (uint i = piece * PIECE; i < min(n, (piece + 1) * PIECE); ++i)
    if (alive[i]) next[place++] = queue[i];
}
