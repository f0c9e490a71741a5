// The multilevel additive Schwarz preconditioner (Dryja, Widlund 1990; affine coarse functions on clusters):
//   z = sum_l P_l B_l^-1 P_l^T r,   A_0 = A,  A_l+1 = W_l^T A_l W_l,  P_l = W_0 ... W_l-1,
// B_l: the diagonal blocks of A_l that the clusters of level l cut out. A coarse function acts alike in the three
// directions, so weights W are scalars and matrices consist of 3 x 3 blocks. host/physics/linear/schwarz_hierarchy.hpp says
// what slots and clusters are.
// A cluster's matrix has `stride` rows, 3 x width rounded up to four; rows that nothing uses have a 1 on the diagonal.
// Matrices are summed and inverted in double precision, inverses and vectors kept in single: CG sees one fixed operator.
// Clusters of all levels are numbered through, the finest first, and their matrices and vectors stand one behind the other.
// P_l is kept as a whole: each slot of the first level has four functions of each coarser level, so that one launch
// restricts to all levels, one solves on all, and one brings all back to the nodes.
#include "shared/lanes.h"
#include "solve/group_sum.cl"
#include "solve/site.h"
#define NO_SLOT 0xffffffffu
#define IN_SECOND (1u << 31)
#define LARGEST_STRIDE 96
#define LONG_PAIR 64u  // parts

// Number `other` of the line of a symmetric matrix that work-item `own` has. Work-items that run side by side take columns,
// so that they read side by side; those that take turns take rows.
#if N_LANES > 1
#define IN_LINE(own, other, stride) ((own) * (stride) + (other))
#else
#define IN_LINE(own, other, stride) ((other) * (stride) + (own))
#endif

// ---- set-up -------------------------------------------------------------------------------------------------------

// The blocks of the next level. n: 16 x pairs of clusters, (a, b) of the four coarse functions of each.
// first: [n_pairs + 1] into source;  source: blocks of this level, which begin at first_block;  row, column: slot of each
// weights: [n_slots x 4];  coarse: [n_pairs x 16 x 9], from block first_coarse on
kernel void schwarz_coarsen(const uint n, global const uint* restrict first, global const uint* restrict source,
                            global const uint* restrict row, global const uint* restrict column,
                            global const real* restrict weights, global const real* blocks, const uint first_block,
                            const uint first_coarse, global real* coarse) {
  const uint i = get_global_id(0);
  if (i >= n) return;
  const uint pair = i / 16, a = i / 4 % 4, b = i % 4;
  real sum[9] = {0, 0, 0, 0, 0, 0, 0, 0, 0};
  for (uint k = first[pair]; k < first[pair + 1]; ++k) {
    const uint block = source[k];
    const real weight = weights[4 * (size_t)row[block] + a] * weights[4 * (size_t)column[block] + b];
    for (int e = 0; e < 9; ++e) sum[e] += weight * blocks[9 * (size_t)(first_block + block) + e];
  }
  for (int e = 0; e < 9; ++e) coarse[9 * (size_t)(first_coarse + i) + e] = sum[e];
}

// Puts blocks that lie within clusters into their matrices, which are zero before.
// n: such blocks;  source: [n] which, of the given matrix (fine) or, IN_SECOND, of the coarser levels' (coarse)
// row: [n] the matrices' row, counted through all clusters, where the block begins;  column: [n] in its matrix
// matrices: [n_clusters x stride x stride]
kernel void schwarz_place(const uint n, const uint stride, global const uint* restrict source,
                          global const uint* restrict row, global const uint* restrict column,
                          global const real* restrict fine, global const real* restrict coarse,
                          global real* restrict matrices) {
  const uint i = get_global_id(0);
  if (i >= n) return;
  const uint block = source[i] & ~IN_SECOND;
  global const real* from = (source[i] & IN_SECOND ? coarse : fine) + 9 * (size_t)block;
  global real* to = matrices + (size_t)row[i] * stride + column[i];
  for (uint k = 0; k < 3; ++k)
    for (uint j = 0; j < 3; ++j) to[k * stride + j] = from[3 * k + j];
}

// Adds what contacts couple, on all levels. A part is one pair of a contact's four sites; parts that fall on the same
// functions are summed in one order. A pair with many parts, as of a rigid body that lies on a mesh, takes a work-group for
// each two functions, other pairs a work-item.
// n_items: 16 x pairs of functions' first slots, (a, b) as above, in whole work-groups; then 64 x 16 x n_long
// pair_row, pair_column: [n_pairs] where their blocks begin, as in schwarz_place
// first: [n_pairs + 1] into the parts;  long_pairs: [n_long] those with more than LONG_PAIR parts
// source: where the part's 3 x 3 block begins in the blocks of one kind of elements, or, IN_SECOND, of the other; rows are
// 12 numbers long;  part_row, part_column: in site_weights
// site_weights: [n_levels x n_sites x 4] of the functions from each site's slot
kernel __attribute__((reqd_work_group_size(ITEMS, 1, 1))) void schwarz_add_contacts(
    const uint n_items, const uint n_pairs, const uint stride, global const uint* restrict pair_row,
    global const uint* restrict pair_column, global const uint* restrict first,
    global const uint* restrict long_pairs, global const uint* restrict source, global const uint* restrict part_row,
    global const uint* restrict part_column, global const real* restrict site_weights,
    global const real* restrict first_blocks, global const real* restrict second_blocks,
    global real* restrict matrices) {
  local real parts[9 * ITEMS];
  local uint is_used;
  const uint item = get_local_id(0), group = get_group_id(0), n_short = (16 * n_pairs + ITEMS - 1) / ITEMS;
  const bool is_shared = group >= n_short;  // by the whole work-group
  const uint i = is_shared ? 16 * long_pairs[(group - n_short) / 16] + (group - n_short) % 16 : group * ITEMS + item;
  const uint pair = i / 16, a = i / 4 % 4, b = i % 4;
  if (item == 0) is_used = 0;
  barrier(CLK_LOCAL_MEM_FENCE);
  uint begin = 0, end = 0;
  if (pair < n_pairs) begin = first[pair], end = first[pair + 1];
  if (!is_shared && end - begin > LONG_PAIR) end = begin;
  real sum[9] = {0, 0, 0, 0, 0, 0, 0, 0, 0};
  bool is_own_used = false;
  for (uint k = begin + (is_shared ? item : 0); k < end; k += is_shared ? ITEMS : 1) {
    const real weight = site_weights[4 * (size_t)part_row[k] + a] * site_weights[4 * (size_t)part_column[k] + b];
    if (weight == 0) continue;
    is_own_used = true;
    global const real* part = (source[k] & IN_SECOND ? second_blocks : first_blocks) + (source[k] & ~IN_SECOND);
    for (int e = 0; e < 9; ++e) sum[e] += weight * part[e / 3 * 12 + e % 3];
  }
  // the slot after a single node may be another's, so what is not used is not written
  global real* to = matrices;
  if (pair < n_pairs) to += (size_t)(pair_row[pair] + 3 * a) * stride + pair_column[pair] + 3 * b;
  for (int e = 0; e < 9; ++e) {
    if (is_shared)
      parts[e * ITEMS + item] = sum[e];
    else if (is_own_used)
      to[e / 3 * stride + e % 3] += sum[e];
  }
  if (is_shared && is_own_used) is_used = 1;
  barrier(CLK_LOCAL_MEM_FENCE);
  if (!is_shared || !is_used || item >= 9) return;
  real all = 0;
  for (uint k = 0; k < ITEMS; ++k) all += parts[item * ITEMS + k];
  to[item / 3 * stride + item % 3] += all;
}

// One pivot of a Gauss-Jordan elimination, for one row or column.  pivot_column: of columns only
static inline void eliminate(const uint own, const uint pivot, const uint n, const uint stride,
                             local const real* restrict pivot_row, local const real* restrict pivot_column,
                             global real* restrict a) {
#if N_LANES > 1
  global real* row = a + own * stride;
  if (own == pivot) {
    for (uint c = 0; c < n; ++c) row[c] = pivot_row[c];
    return;
  }
  const real factor = row[pivot];
  row[pivot] = 0;
  for (uint c = 0; c < n; ++c) row[c] -= factor * pivot_row[c];
#else
  for (uint r = 0; r < n; ++r) {
    const real before = own == pivot ? 0 : a[r * stride + own];
    a[r * stride + own] = r == pivot ? pivot_row[own] : before - pivot_column[r] * pivot_row[own];
  }
#endif
}

// Inverts each cluster's matrix in place by Gauss-Jordan elimination, which needs no pivoting: it is positive definite.
// One work-group of 64 per cluster; each work-item owns rows or columns. Rows behind the last used one are left out.
// failed: [n_clusters] 1 where a pivot is not positive;  inverse: the same in single precision, exactly symmetric
kernel __attribute__((reqd_work_group_size(64, 1, 1))) void schwarz_invert(const uint n, const uint stride,
                                                                           global real* restrict matrices,
                                                                           global float* restrict inverse,
                                                                           global uint* restrict failed) {
  local real pivot_row[LARGEST_STRIDE], pivot_column[LARGEST_STRIDE];
  const uint cluster = get_group_id(0), item = get_local_id(0);
  if (cluster * 64 >= n) return;  // whole groups
  global real* a = matrices + (size_t)cluster * stride * stride;
  uint n_used = stride;
  while (n_used > 0 && a[(n_used - 1) * (stride + 1)] == 0) --n_used;
  barrier(CLK_GLOBAL_MEM_FENCE);  // the zeros are counted before they become ones
  for (uint r = item; r < stride; r += 64)
    if (a[r * stride + r] == 0) a[r * stride + r] = 1;
  uint has_failed = 0;
  for (uint p = 0; p < n_used; ++p) {
    barrier(CLK_LOCAL_MEM_FENCE | CLK_GLOBAL_MEM_FENCE);
    const real pivot = a[p * stride + p];
    has_failed |= !(pivot > 0);
    for (uint k = item; k < n_used; k += 64) pivot_row[k] = (k == p ? 1 : a[p * stride + k]) / pivot;
#if N_LANES == 1
    for (uint k = item; k < n_used; k += 64) pivot_column[k] = a[k * stride + p];
#endif
    barrier(CLK_LOCAL_MEM_FENCE | CLK_GLOBAL_MEM_FENCE);
    for (uint own = item; own < n_used; own += 64) eliminate(own, p, n_used, stride, pivot_row, pivot_column, a);
  }
  barrier(CLK_GLOBAL_MEM_FENCE);
  for (uint own = item; own < stride; own += 64)
    for (uint other = 0; other < stride; ++other) {
      const uint at = IN_LINE(own, other, stride), across = IN_LINE(other, own, stride);
      inverse[(size_t)cluster * stride * stride + at] = (float)(0.5 * (a[at] + a[across]));
    }
  if (item == 0) failed[cluster] = has_failed;
}

// ---- application --------------------------------------------------------------------------------------------------

// What each cluster of the first level adds to the functions of each coarser one.
// n: n_clusters x n_coarser, clusters of the first level
// node: [n_slots] of each slot, NO_SLOT where it is not used;  functions: [n_slots x n_coarser x 4]
// parts: [n x 3 x 4] by direction, then by function
kernel void schwarz_restrict(const uint n, const uint width, const uint n_coarser, global const uint* restrict node,
                             global const float* restrict functions, global const real* restrict residual,
                             global real* restrict parts) {
  const uint i = get_global_id(0);
  if (i >= n) return;
  const uint cluster = i / n_coarser, level = i % n_coarser;
  double4 x = (double4)(0), y = (double4)(0), z = (double4)(0);
  for (uint s = cluster * width; s < (cluster + 1) * width; ++s) {
    if (node[s] == NO_SLOT) continue;
    const double4 weight = convert_double4(vload4((size_t)s * n_coarser + level, functions));
    const real3 r = vload3(node[s], residual);
    x += weight * r.x;
    y += weight * r.y;
    z += weight * r.z;
  }
  vstore4(x, 3 * (size_t)i, parts);
  vstore4(y, 3 * (size_t)i + 1, parts);
  vstore4(z, 3 * (size_t)i + 2, parts);
}

// One number of P_l^T r: of the first level a node's, of a coarser one the sum over clusters of the first level.
// row: in the cluster;  first: [functions of all coarser clusters, by fours, + 1] into member;  member: these clusters
static inline real restricted(const uint cluster, const uint row, const uint n_finest, const uint width,
                              const uint n_coarser, global const uint* restrict node, global const uint* restrict level,
                              global const uint* restrict first, global const uint* restrict member,
                              global const real* restrict parts, global const real* restrict residual) {
  const uint slot = row / 3, direction = row % 3;
  if (slot >= width) return 0;
  if (cluster < n_finest) {
    const uint i = node[cluster * width + slot];
    return i == NO_SLOT ? 0 : residual[3 * (size_t)i + direction];
  }
  const uint fours = (cluster - n_finest) * (width / 4) + slot / 4;
  if (slot / 4 >= width / 4) return 0;
  real sum = 0;
  for (uint k = first[fours]; k < first[fours + 1]; ++k)
    sum += parts[((size_t)member[k] * n_coarser + level[cluster] - 1) * 12 + 4 * direction + slot % 4];
  return sum;
}

// z = B^-1 P_l^T r on all levels. A work-group has one cluster, or as many as fill it.
// n_items: 64 for each work-group;  n_finest: clusters of the first level;  level: [n_clusters]
kernel __attribute__((reqd_work_group_size(ITEMS, 1, 1))) void schwarz_solve(
    const uint n_items, const uint n_clusters, const uint n_finest, const uint width, const uint stride,
    const uint n_coarser, global const uint* restrict node, global const uint* restrict level,
    global const uint* restrict first, global const uint* restrict member, global const real* restrict parts,
    global const real* restrict residual, global const float* restrict inverse, global float* restrict z) {
  local float r[LARGEST_STRIDE];
  const uint per_group = max(1u, ITEMS / stride), begin = get_group_id(0) * per_group;
  const uint n_rows = min(per_group, n_clusters - begin) * stride;
  for (uint q = get_local_id(0); q < n_rows; q += ITEMS)
    r[q] = (float)restricted(begin + q / stride, q % stride, n_finest, width, n_coarser, node, level, first, member,
                             parts, residual);
  barrier(CLK_LOCAL_MEM_FENCE);
  for (uint q = get_local_id(0); q < n_rows; q += ITEMS) {
    local const float* own = r + q / stride * stride;
    float4 sums = (float4)(0);
#if N_LANES > 1
    global const float* a = inverse + ((size_t)begin * stride + q) * stride;
    for (uint k = 0; k < stride / 4; ++k) sums += vload4(k, a) * vload4(k, own);
#else
    global const float* a = inverse + (size_t)(begin + q / stride) * stride * stride + q % stride;
    for (uint k = 0; k < stride / 4; ++k, a += 4 * stride)
      sums += (float4)(a[0], a[stride], a[2 * stride], a[3 * stride]) * vload4(k, own);
#endif
    z[(size_t)begin * stride + q] = (sums.x + sums.y) + (sums.z + sums.w);
  }
}

// B^-1 r of one node with inverses in double precision
// node: [n_slots];  inverses: [n_clusters x stride x stride], as schwarz_invert leaves them
static inline real3 exact_correction(const uint own_slot, const uint width, const uint stride,
                                     global const uint* restrict node, global const real* restrict inverses,
                                     global const real* restrict residual) {
  const uint cluster = own_slot / width, row = 3 * (own_slot % width);
  global const real* a = inverses + (size_t)cluster * stride * stride;
  real3 sum = (real3)(0);
  for (uint k = 0; k < width; ++k) {
    const uint from = node[cluster * width + k];
    if (from == NO_SLOT) continue;
    for (uint c = 3 * k; c < 3 * k + 3; ++c) {  // the mean of both halves is exactly symmetric
      const real3 lower = (real3)(a[row * stride + c], a[(row + 1) * stride + c], a[(row + 2) * stride + c]);
      sum += 0.5 * residual[3 * (size_t)from + c - 3 * k] * (lower + vload3(0, a + c * stride + row));
    }
  }
  return sum;
}

// From all levels back to nodes; a node without slot gets zero. Besides the exact corrections of stiff rigid bodies.
// n_items: 64 for each chunk of at most 64 nodes;  slot: [n_nodes];  functions: as above
// coarser: [n_clusters of the first level x n_coarser] where the four functions of each coarser level stand in z
// exact_*: as of exact_correction, if has_exact
// partial: [n_chunks] sum of residual . preconditioned
kernel __attribute__((reqd_work_group_size(ITEMS, 1, 1))) void schwarz_prolong(
    const uint n_items, global const Chunk* restrict chunks, const uint width, const uint stride, const uint n_coarser,
    global const uint* restrict slot, global const uint* restrict coarser, global const float* restrict functions,
    global const float* restrict z, const uint has_exact, const uint exact_width, const uint exact_stride,
    global const uint* restrict exact_slot, global const uint* restrict exact_node,
    global const real* restrict exact_inverses, global const real* restrict residual,
    global real* restrict preconditioned, global real* restrict partial) {
  local real of_item[ITEMS + EIGHTS];
  const Chunk chunk = chunks[get_group_id(0)];
  const uint i = chunk.begin + get_local_id(0);
  real own = 0;
  if (i < chunk.end) {
    const uint s = slot[i];
    float3 value = (float3)(0);
    if (s != NO_SLOT) {
      value = vload3(0, z + (size_t)(s / width) * stride + 3 * (s % width));
      for (uint l = 0; l < n_coarser; ++l) {
        global const float* coarse = z + coarser[s / width * n_coarser + l];
        const float4 weight = vload4((size_t)s * n_coarser + l, functions);
        value += (weight.x * vload3(0, coarse) + weight.y * vload3(1, coarse)) +
                 (weight.z * vload3(2, coarse) + weight.w * vload3(3, coarse));
      }
    }
    real3 all = convert_double3(value);
    if (has_exact && exact_slot[i] != NO_SLOT)
      all += exact_correction(exact_slot[i], exact_width, exact_stride, exact_node, exact_inverses, residual);
    vstore3(all, i, preconditioned);
    own = dot(vload3(i, residual), all);
  }
  const real sum = sum_of_group(own, of_item);
  if (get_local_id(0) == 0) partial[get_group_id(0)] = sum;
}
