// A sparse matrix of 3 x 3 blocks, by rows: block k of row i, from first[i] to first[i + 1], stands in column[k].
//   y_i = sum_k A_k x_column[k]
// Both halves of the symmetric matrix are kept, so that every row is one work-item's own and the order of sums is fixed.
#include "shared/real.h"

// n: rows.  blocks: [n_blocks x 9, row-major];  x, y: [n x 3]
kernel void block_product(const uint n, global const uint* restrict first, global const uint* restrict column,
                          global const real* restrict blocks, global const real* restrict x, global real* restrict y) {
  const uint i = get_global_id(0);
  if (i >= n) return;
  real3 sum = (real3)(0);
  for (uint k = first[i]; k < first[i + 1]; ++k) {
    global const real* a = blocks + 9 * (size_t)k;
    const real3 v = vload3(column[k], x);
    sum.x += a[0] * v.x + a[1] * v.y + a[2] * v.z;
    sum.y += a[3] * v.x + a[4] * v.y + a[5] * v.z;
    sum.z += a[6] * v.x + a[7] * v.y + a[8] * v.z;
  }
  vstore3(sum, i, y);
}

// Adds the parts of dense element blocks that fall on each block of the matrix, in the order of the elements.
// n: blocks that these elements touch;  touched: [n] which;  part_first: [n + 1] into source and weight;
// source: where the part's first number stands in element_blocks, whose rows are `width` numbers long
kernel void add_element_blocks(const uint n, const uint width, global const uint* restrict touched,
                               global const uint* restrict part_first, global const uint* restrict source,
                               global const real* restrict weight, global const real* restrict element_blocks,
                               global real* restrict blocks) {
  const uint i = get_global_id(0);
  if (i >= n) return;
  real3 row0 = (real3)(0), row1 = (real3)(0), row2 = (real3)(0);
  for (uint k = part_first[i]; k < part_first[i + 1]; ++k) {
    global const real* part = element_blocks + source[k];
    row0 += weight[k] * vload3(0, part);
    row1 += weight[k] * vload3(0, part + width);
    row2 += weight[k] * vload3(0, part + 2 * width);
  }
  global real* block = blocks + 9 * (size_t)touched[i];
  vstore3(vload3(0, block) + row0, 0, block);
  vstore3(vload3(1, block) + row1, 1, block);
  vstore3(vload3(2, block) + row2, 2, block);
}
