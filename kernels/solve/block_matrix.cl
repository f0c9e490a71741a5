// A sparse matrix of 3 x 3 blocks, by rows: block k of row i, from first[i] to first[i + 1], stands in column[k].
//   y_i = sum_k A_k x_column[k]
// Both halves of the symmetric matrix are kept, so that every row is one work-item's own and the order of sums is fixed.
#include "solve/row_lists.cl"
#include "solve/site.h"
#define NEW_TERM (1u << 31)
#define TRANSPOSED (1u << 30)

static inline real3 product_of_row(const uint i, global const uint* restrict first, global const uint* restrict column,
                                  global const real* restrict blocks, global const real* restrict x) {
  real3 sum = (real3)(0);
  for (uint k = first[i]; k < first[i + 1]; ++k) {
    global const real* a = blocks + 9 * (size_t)k;
    const real3 v = vload3(column[k], x);
    sum.x += a[0] * v.x + a[1] * v.y + a[2] * v.z;
    sum.y += a[3] * v.x + a[4] * v.y + a[5] * v.z;
    sum.z += a[6] * v.x + a[7] * v.y + a[8] * v.z;
  }
  return sum;
}

#if N_LANES == 1
#define TILE (4u * ITEMS)  // blocks
// The same for the 64 rows from `begin` on, at most up to `end`, whose blocks stand one behind the other: work-items side by
// side take blocks side by side, and each row adds up what was found for it, in the same order.
static inline real3 product_of_own_row(const uint begin, const uint end, global const uint* restrict first,
                                       global const uint* restrict column, global const real* restrict blocks,
                                       global const real* restrict x, local real* found) {
  const uint item = get_local_id(0), own = min(begin + item, end);
  const uint own_first = first[own], own_last = first[min(own + 1, end)], last = first[end];
  real3 sum = (real3)(0);
  for (uint tile = first[begin]; tile < last; tile += TILE) {
    for (uint k = tile + item; k < min(last, tile + TILE); k += ITEMS) {
      global const real* a = blocks + 9 * (size_t)k;
      const real3 v = vload3(column[k], x);
      vstore3((real3)(a[0] * v.x + a[1] * v.y + a[2] * v.z, a[3] * v.x + a[4] * v.y + a[5] * v.z,
                      a[6] * v.x + a[7] * v.y + a[8] * v.z),
              k - tile, found);
    }
    barrier(CLK_LOCAL_MEM_FENCE);
    for (uint k = max(own_first, tile); k < min(own_last, tile + TILE); ++k) sum += vload3(k - tile, found);
    barrier(CLK_LOCAL_MEM_FENCE);
  }
  return sum;
}
#endif

// n: rows.  blocks: [n_blocks x 9, row-major];  x, y: [n x 3]
kernel void block_product(const uint n, global const uint* restrict first, global const uint* restrict column,
                          global const real* restrict blocks, global const real* restrict x, global real* restrict y) {
  const uint i = get_global_id(0);
  if (i < n) vstore3(product_of_row(i, first, column, blocks, x), i, y);
}

// The same, and the rows of elements outside the matrix, as gather_rows of solve/nodes.cl adds them, if has_rows.
// n_items: 64 for each chunk of at most 64 matrix rows;  partial: [n_chunks] sum of x . y over it
kernel __attribute__((reqd_work_group_size(ITEMS, 1, 1))) void block_product_and_dot(
    const uint n_items, global const Chunk* restrict chunks, global const uint* restrict first,
    global const uint* restrict column, global const real* restrict blocks, const uint has_rows,
    global const uint* restrict offset, global const uint* restrict row, global const real* restrict weight,
    global const uint* restrict is_fixed, global const real* restrict rows, global const real* restrict x,
    global real* restrict y, global real* restrict partial) {
  local real of_item[ITEMS + EIGHTS];
  local LongLists long_lists;
  const Chunk chunk = chunks[get_group_id(0)];
  const uint i = chunk.begin + get_local_id(0);
  const RowLists lists = {offset, row, weight, rows};
#if N_LANES == 1
  local real found[3 * TILE];
  const real3 product = product_of_own_row(chunk.begin, chunk.end, first, column, blocks, x, found);
#else
  const real3 product = i < chunk.end ? product_of_row(i, first, column, blocks, x) : (real3)(0);
#endif
  if (i < chunk.end) vstore3(has_rows && !is_fixed[i] ? add_short_list(&lists, i, product) : product, i, y);
  if (has_rows) add_long_lists(&lists, chunk.begin, chunk.end, is_fixed, y, &long_lists);
  const real sum = sum_of_group(i < chunk.end ? dot(vload3(i, x), vload3(i, y)) : 0, of_item);
  if (get_local_id(0) == 0) partial[get_group_id(0)] = sum;
}

// Each block of the matrix is the sum of the parts of dense element blocks that fall on it: of each term by itself, in
// the order of its elements, then of the terms in their order. Of element blocks only the upper half is read, of the
// matrix only the upper half summed; both halves are written.
// n: of the blocks on and above the diagonal, from `begin` on;  place: [n_blocks x 2] where each stands in the matrix, and
// its transpose
// part_first: [n_blocks + 1] into the parts;  source: where the part's first number stands in element_blocks;
// width: how long its rows are there, NEW_TERM where the part is the first one of a term, TRANSPOSED where it falls on
// the transposed block
kernel void assemble_blocks(const uint n, const uint begin, global const uint* restrict place, global const uint* restrict part_first,
                            global const uint* restrict source, global const uint* restrict width,
                            global const real* restrict weight, global const real* restrict element_blocks,
                            global real* restrict blocks) {
  const uint i = begin + get_global_id(0);
  if (i >= begin + n) return;
  real3 sum0 = (real3)(0), sum1 = (real3)(0), sum2 = (real3)(0);
  real3 row0 = (real3)(0), row1 = (real3)(0), row2 = (real3)(0);
  for (uint k = part_first[i]; k < part_first[i + 1]; ++k) {
    if (width[k] & NEW_TERM) {
      sum0 += row0, sum1 += row1, sum2 += row2;
      row0 = row1 = row2 = (real3)(0);
    }
    const uint w = width[k] & ~(NEW_TERM | TRANSPOSED);
    global const real* part = element_blocks + source[k];
    const real3 p0 = vload3(0, part), p1 = vload3(0, part + w), p2 = vload3(0, part + 2 * w);
    if (width[k] & TRANSPOSED) {
      row0 += weight[k] * (real3)(p0.x, p1.x, p2.x);
      row1 += weight[k] * (real3)(p0.y, p1.y, p2.y);
      row2 += weight[k] * (real3)(p0.z, p1.z, p2.z);
    } else {
      row0 += weight[k] * p0;
      row1 += weight[k] * p1;
      row2 += weight[k] * p2;
    }
  }
  sum0 += row0, sum1 += row1, sum2 += row2;
  global real* block = blocks + 9 * (size_t)place[2 * i];
  vstore3(sum0, 0, block);
  vstore3(sum1, 1, block);
  vstore3(sum2, 2, block);
  if (place[2 * i] == place[2 * i + 1]) return;
  block = blocks + 9 * (size_t)place[2 * i + 1];
  vstore3((real3)(sum0.x, sum1.x, sum2.x), 0, block);
  vstore3((real3)(sum0.y, sum1.y, sum2.y), 1, block);
  vstore3((real3)(sum0.z, sum1.z, sum2.z), 2, block);
}
