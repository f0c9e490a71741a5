// A sparse matrix of 3 x 3 blocks, by rows: block k of row i, from first[i] to first[i + 1], stands in column[k].
//   y_i = sum_k A_k x_column[k]
// Both halves of the symmetric matrix are kept, so that every row is one work-item's own and the order of sums is fixed.
#include "solve/assemble_block.cl"
#include "solve/row_lists.cl"
#include "solve/site.h"

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

// Block i of the assembled matrix: see assemble_block.  n: of the blocks on and above the diagonal, from `begin` on
kernel void assemble_blocks(const uint n, const uint begin, global const uint* restrict place, global const uint* restrict part_first,
                            global const uint* restrict source, global const real* restrict weight,
                            global const real* restrict element_blocks, global real* restrict blocks) {
  const uint i = get_global_id(0);
  if (i < n) assemble_block(begin + i, place, part_first, source, weight, element_blocks, blocks);
}
