// The multilevel additive Schwarz preconditioner (Dryja, Widlund 1990; affine coarse functions on clusters):
//   z = sum_l P_l B_l^-1 P_l^T r,   A_0 = A,  A_l+1 = W_l^T A_l W_l,  P_l = W_0 ... W_l-1,
// B_l: the diagonal blocks of A_l that the clusters of level l cut out. A coarse function acts alike in the three
// directions, so weights W are scalars and matrices consist of 3 x 3 blocks. host/physics/linear/schwarz_hierarchy.hpp says
// what slots and clusters are.
// A cluster's matrix has `stride` rows, 3 x width rounded up to four; rows that nothing uses have a 1 on the diagonal.
// Matrices are summed and inverted in double precision, inverses and vectors kept in single: CG sees one fixed operator.
#include "shared/real.h"
#define NO_SLOT 0xffffffffu

// ---- set-up -------------------------------------------------------------------------------------------------------

// The blocks of the next level. n: 16 x pairs of clusters, (a, b) of the four coarse functions of each.
// first: [n_pairs + 1] into source;  source: blocks of this level;  row, column: slot of each of them
// weights: [n_slots x 4];  coarse: [n_pairs x 16 x 9]
kernel void schwarz_coarsen(const uint n, global const uint* restrict first, global const uint* restrict source,
                            global const uint* restrict row, global const uint* restrict column,
                            global const real* restrict weights, global const real* restrict blocks,
                            global real* restrict coarse) {
  const uint i = get_global_id(0);
  if (i >= n) return;
  const uint pair = i / 16, a = i / 4 % 4, b = i % 4;
  real sum[9] = {0, 0, 0, 0, 0, 0, 0, 0, 0};
  for (uint k = first[pair]; k < first[pair + 1]; ++k) {
    const uint block = source[k];
    const real weight = weights[4 * (size_t)row[block] + a] * weights[4 * (size_t)column[block] + b];
    for (int e = 0; e < 9; ++e) sum[e] += weight * blocks[9 * (size_t)block + e];
  }
  for (int e = 0; e < 9; ++e) coarse[9 * (size_t)i + e] = sum[e];
}

// Puts blocks that lie within a cluster into its matrix, which is zero before.
// n: such blocks;  within: [n] which;  matrices: [n_clusters x stride x stride]
kernel void schwarz_place(const uint n, const uint width, const uint stride, global const uint* restrict within,
                          global const uint* restrict row, global const uint* restrict column,
                          global const real* restrict blocks, global real* restrict matrices) {
  const uint i = get_global_id(0);
  if (i >= n) return;
  const uint block = within[i], r = row[block], c = column[block];
  global real* to = matrices + ((size_t)(r / width) * stride + 3 * (r % width)) * stride + 3 * (c % width);
  for (uint k = 0; k < 3; ++k)
    for (uint j = 0; j < 3; ++j) to[k * stride + j] = blocks[9 * (size_t)block + 3 * k + j];
}

// Adds what contacts couple. A part is one pair of a contact's four sites; parts that fall on the same functions are
// summed in one order.
// n: 16 x pairs of functions' first slots, (a, b) as above;  pair_row, pair_column: [n_pairs] these slots
// first: [n_pairs + 1] into the parts;  source: where the part's 3 x 3 block begins in element_blocks, whose rows are 12
// numbers long;  part_row, part_column: its sites;  site_weights: [n_sites x 4] of the functions from each site's slot
kernel void schwarz_add_contacts(const uint n, const uint width, const uint stride,
                                 global const uint* restrict pair_row, global const uint* restrict pair_column,
                                 global const uint* restrict first, global const uint* restrict source,
                                 global const uint* restrict part_row, global const uint* restrict part_column,
                                 global const real* restrict site_weights, global const real* restrict element_blocks,
                                 global real* restrict matrices) {
  const uint i = get_global_id(0);
  if (i >= n) return;
  const uint pair = i / 16, a = i / 4 % 4, b = i % 4;
  real sum[9] = {0, 0, 0, 0, 0, 0, 0, 0, 0};
  bool is_used = false;
  for (uint k = first[pair]; k < first[pair + 1]; ++k) {
    const real weight = site_weights[4 * (size_t)part_row[k] + a] * site_weights[4 * (size_t)part_column[k] + b];
    if (weight == 0) continue;
    is_used = true;
    global const real* part = element_blocks + source[k];
    for (int e = 0; e < 9; ++e) sum[e] += weight * part[e / 3 * 12 + e % 3];
  }
  if (!is_used) return;  // the slot after a single node may be another's
  const uint r = pair_row[pair] + a, c = pair_column[pair] + b;
  global real* to = matrices + ((size_t)(r / width) * stride + 3 * (r % width)) * stride + 3 * (c % width);
  for (uint k = 0; k < 3; ++k)
    for (uint j = 0; j < 3; ++j) to[k * stride + j] += sum[3 * k + j];
}

// Inverts each cluster's matrix in place by Gauss-Jordan elimination, which needs no pivoting: it is positive definite.
// One work-group of 64 per cluster; each work-item owns rows.
// failed: [first + n_clusters] 1 where a pivot is not positive;  inverse: the same in single precision, exactly symmetric
kernel __attribute__((reqd_work_group_size(64, 1, 1))) void schwarz_invert(const uint n, const uint stride, const uint first,
                                                                           global real* restrict matrices,
                                                                           global float* restrict inverse,
                                                                           global uint* restrict failed) {
  local real pivot_row[96];
  const uint cluster = get_group_id(0), item = get_local_id(0);
  if (cluster * 64 >= n) return;  // whole groups
  global real* a = matrices + (size_t)cluster * stride * stride;
  for (uint r = item; r < stride; r += 64)
    if (a[r * stride + r] == 0) a[r * stride + r] = 1;
  uint has_failed = 0;
  for (uint p = 0; p < stride; ++p) {
    barrier(CLK_LOCAL_MEM_FENCE | CLK_GLOBAL_MEM_FENCE);
    const real pivot = a[p * stride + p];
    has_failed |= !(pivot > 0);
    for (uint c = item; c < stride; c += 64) pivot_row[c] = (c == p ? 1 : a[p * stride + c]) / pivot;
    barrier(CLK_LOCAL_MEM_FENCE | CLK_GLOBAL_MEM_FENCE);
    for (uint r = item; r < stride; r += 64) {
      global real* row = a + r * stride;
      if (r == p) {
        for (uint c = 0; c < stride; ++c) row[c] = pivot_row[c];
        continue;
      }
      const real factor = row[p];
      row[p] = 0;
      for (uint c = 0; c < stride; ++c) row[c] -= factor * pivot_row[c];
    }
  }
  barrier(CLK_GLOBAL_MEM_FENCE);
  for (uint r = item; r < stride; r += 64)
    for (uint c = 0; c < stride; ++c)
      inverse[((size_t)cluster * stride + r) * stride + c] = (float)(0.5 * (a[r * stride + c] + a[c * stride + r]));
  if (item == 0) failed[first + cluster] = has_failed;
}

// ---- application --------------------------------------------------------------------------------------------------

// residual of nodes to slots of the first level.  node: [n_slots], NO_SLOT where a slot is not used
// restricted: [n_clusters x stride]
kernel void schwarz_gather(const uint n, const uint width, const uint stride, global const uint* restrict node,
                           global const real* restrict residual, global float* restrict restricted) {
  const uint slot = get_global_id(0);
  if (slot >= n || node[slot] == NO_SLOT) return;
  vstore3(convert_float3(vload3(node[slot], residual)), 0,
          restricted + (size_t)(slot / width) * stride + 3 * (slot % width));
}

// W^T r: n: 4 x clusters of the finer level;  parent: [n_clusters] first slot of each on the coarser one
kernel void schwarz_restrict(const uint n, const uint width, const uint stride, global const uint* restrict parent,
                             global const real* restrict weights, global const float* restrict fine,
                             global float* restrict coarse) {
  const uint i = get_global_id(0);
  if (i >= n) return;
  const uint cluster = i / 4, a = i % 4, slot = parent[cluster] + a;
  float3 sum = (float3)(0);
  for (uint k = 0; k < width; ++k)
    sum += (float)weights[4 * ((size_t)cluster * width + k) + a] * vload3(k, fine + (size_t)cluster * stride);
  vstore3(sum, 0, coarse + (size_t)(slot / width) * stride + 3 * (slot % width));
}

// z = B^-1 r + W z of the coarser level.  n: n_clusters x stride rows;  has_coarser: 0 on the last level
kernel void schwarz_solve(const uint n, const uint width, const uint stride, global const float* restrict inverse,
                          global const float* restrict restricted, const uint has_coarser,
                          global const uint* restrict parent, global const real* restrict weights,
                          global const float* restrict coarse, global float* restrict z) {
  const uint i = get_global_id(0);
  if (i >= n) return;
  const uint cluster = i / stride, row = i % stride;
  global const float* a = inverse + (size_t)i * stride;
  global const float* r = restricted + (size_t)cluster * stride;
  float4 sums = (float4)(0);
  for (uint k = 0; k < stride / 4; ++k) sums += vload4(k, a) * vload4(k, r);
  float sum = (sums.x + sums.y) + (sums.z + sums.w);
  if (has_coarser && row < 3 * width) {
    const size_t slot = (size_t)cluster * width + row / 3;
    for (uint b = 0; b < 4; ++b) {
      const uint p = parent[cluster] + b;
      sum += (float)weights[4 * slot + b] * coarse[(size_t)(p / width) * stride + 3 * (p % width) + row % 3];
    }
  }
  z[i] = sum;
}

// slots of the first level to nodes; a node without slot gets zero.  slot: [n_nodes]
kernel void schwarz_scatter(const uint n, const uint width, const uint stride, global const uint* restrict slot,
                            global const float* restrict z, global real* restrict preconditioned) {
  const uint node = get_global_id(0);
  if (node >= n) return;
  const uint s = slot[node];
  const real3 value =
      s == NO_SLOT ? (real3)(0) : convert_double3(vload3(0, z + (size_t)(s / width) * stride + 3 * (s % width)));
  vstore3(value, node, preconditioned);
}

// z += B^-1 r with the inverses in double precision, for stiff rigid bodies.  n: n_clusters x stride rows
// inverses: [n_clusters x stride x stride], as schwarz_invert leaves them;  preconditioned: [n_nodes x 3]
kernel void schwarz_add_exactly(const uint n, const uint width, const uint stride, global const uint* restrict node,
                                global const real* restrict inverses, global const real* restrict residual,
                                global real* restrict preconditioned) {
  const uint i = get_global_id(0);
  if (i >= n) return;
  const uint cluster = i / stride, row = i % stride;
  if (row >= 3 * width || node[cluster * width + row / 3] == NO_SLOT) return;
  global const real* a = inverses + (size_t)cluster * stride * stride;
  real sum = 0;
  for (uint k = 0; k < width; ++k) {
    const uint from = node[cluster * width + k];
    if (from == NO_SLOT) continue;
    for (uint c = 0; c < 3; ++c)  // the mean of both halves is exactly symmetric
      sum += 0.5 * (a[row * stride + 3 * k + c] + a[(3 * k + c) * stride + row]) * residual[3 * (size_t)from + c];
  }
  preconditioned[3 * (size_t)node[cluster * width + row / 3] + row % 3] += sum;
}
