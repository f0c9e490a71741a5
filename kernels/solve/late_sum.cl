// The sum of a world's chunks, then of elements of which only the device knows how many each world has: late_first[w] to
// late_first[w + 1], counted from element `from`, if has_late. By one work-group, in two parts with a barrier between them.
// late_partial: [n_worlds x most], the most chunks of late elements that a world may have; the rest as in
// solve/world_reduce.cl
#ifndef PVG_SOLVE_LATE_SUM_CL
#define PVG_SOLVE_LATE_SUM_CL
#include "solve/world_sum.cl"
#define CHUNK_LENGTH 128u

static inline uint n_late_chunks(const uint w, const uint has_late, global const uint* restrict late_first) {
  return !has_late ? 0 : (late_first[w + 1] - late_first[w] + CHUNK_LENGTH - 1) / CHUNK_LENGTH;
}

static inline void start_late_sum(const uint w, const uint has_partial, global const uint* restrict first,
                                  global const Chunk* restrict chunks, global const real* restrict a,
                                  global real* partial, const uint has_late, const uint most, const uint from,
                                  global const uint* restrict late_first, global real* late_partial) {
  const uint item = get_local_id(0), begin = first[w], end = first[w + 1];
  for (uint c = has_partial ? end : begin + item; c < end; c += ITEMS)
    partial[c] = sum_of(chunks[c].begin, chunks[c].end, a);
  const uint n_late = n_late_chunks(w, has_late, late_first);
  const uint late_begin = has_late ? late_first[w] : 0, late_end = has_late ? late_first[w + 1] : 0;
  for (uint c = item; c < n_late; c += ITEMS) {
    const uint chunk = late_begin + c * CHUNK_LENGTH;
    late_partial[w * most + c] = sum_of(from + chunk, from + min(late_end, chunk + CHUNK_LENGTH), a);
  }
}

static inline real late_sum(const uint w, global const uint* restrict first, global const real* partial,
                            const uint has_late, const uint most, global const uint* restrict late_first, global const real* late_partial) {
  const real sum = sum_of(first[w], first[w + 1], partial);
  return add_up(sum, w * most, w * most + n_late_chunks(w, has_late, late_first), late_partial);
}

#endif
