// Puts the matrix into the fronts of its factor: the blocks of the assembled matrix, and those of contact and friction
// as far as the factor has a place for them.
#include "shared/real.h"
#include "solve/site.h"
#define NO_BLOCK 0xffffffffu
#define IS_TRANSPOSED (1u << 31)
#define ITEMS 64u
#define SHARES 16u   // work-items of a block, which share what contacts add to it
#define NUMBERS 10u  // what each of them finds: a block's nine and what is left out

// What contacts couple: elements of four sites, of two kinds, and of each node the list of (element, slot) that it
// carries, as rows of the elements.
typedef struct {
  uint n_first, first_row;
  global const uint *offset, *row;
  global const real* weight;
  global const uint* element_sites;
  global const Site* sites;
  global const real *first_blocks, *second_blocks;
} Contacts;

// of one element, 12 x 12: the 3 x 3 block of two slots
static inline global const real* slot_block(const Contacts* c, const uint e, const uint row_slot, const uint column_slot) {
  global const real* blocks =
      e < c->n_first ? c->first_blocks + 144 * (size_t)e : c->second_blocks + 144 * (size_t)(e - c->n_first);
  return blocks + 36 * row_slot + 3 * column_slot;
}

static inline real size_of(global const real* block) {
  real square = 0;
  for (uint r = 0; r < 3; ++r)
    for (uint k = 0; k < 3; ++k) square += block[12 * r + k] * block[12 * r + k];
  return sqrt(square);
}

// whether the lower triangle of the pattern has a block of two nodes; rows ascend
static inline bool has_block(const uint a, const uint b, global const uint* restrict block_first,
                             global const uint* restrict block_last, global const uint* restrict row) {
  const uint wanted = max(a, b);
  uint first = block_first[min(a, b)], last = block_last[min(a, b)];
  while (first < last) {
    const uint middle = (first + last) / 2;
    if (row[middle] < wanted)
      first = middle + 1;
    else
      last = middle;
  }
  return first < block_last[min(a, b)] && row[first] == wanted;
}

// n_items: SHARES for each of n blocks of all groups' lower triangles, by column, then 3 for each hole: a block of the
// panels that nothing is placed in, which is cleared;  row, column: their nodes;  source: in the matrix, NO_BLOCK: none
// place: its first number in `panels`;  stride: of the panel's columns, and IS_TRANSPOSED
// block_first, block_last: [n_nodes] of the blocks of a node's column;  node_group: [n_nodes]
// contact_*: see Contacts; n_contacts = 0: none.  failed: [n_groups, <= n], cleared
// hole_place, hole_stride: [n_holes] as of blocks
// A block C that contacts couple without a place in the factor is left out, and its size goes to both diagonals, as
// |C| (x^2 + y^2) - 2 x C y >= 0.
kernel __attribute__((reqd_work_group_size(ITEMS, 1, 1))) void factor_place_blocks(
                                const uint n_items, const uint n, const uint n_groups, global const uint* restrict row,
                                global const uint* restrict column, global const uint* restrict source,
                                global const uint* restrict place, global const uint* restrict stride,
                                global const real* restrict matrix_blocks, global const uint* restrict block_first,
                                global const uint* restrict block_last, global const uint* restrict node_group,
                                const uint n_contacts, const uint n_first, const uint first_row,
                                global const uint* restrict contact_offset, global const uint* restrict contact_row,
                                global const real* restrict contact_weight, global const uint* restrict element_sites,
                                global const Site* restrict sites, global const real* restrict first_blocks,
                                global const real* restrict second_blocks, const uint n_holes,
                                global const uint* restrict hole_place, global const uint* restrict hole_stride,
                                global uint* restrict failed, global real* restrict panels) {
  local real found[ITEMS * NUMBERS];
  const uint item = get_local_id(0), share = item % SHARES, i = get_global_id(0) / SHARES;
  if (share == 0 && i < n_groups && i < n) failed[i] = 0;
  real3 sum0 = (real3)(0), sum1 = (real3)(0), sum2 = (real3)(0);  // rows
  real left_out = 0;
  const uint r = i < n ? row[i] : 0, c = i < n ? column[i] : 0;
  if (n_contacts > 0 && i < n) {
    const Contacts contacts = {n_first,        first_row, contact_offset, contact_row, contact_weight, element_sites, sites,
                               first_blocks, second_blocks};
    for (uint k = contact_offset[c] + share; k < contact_offset[c + 1]; k += SHARES) {
      const uint e = (contact_row[k] - first_row) / 4, column_slot = (contact_row[k] - first_row) % 4;
      for (uint row_slot = 0; row_slot < 4; ++row_slot) {
        global const Site* site = sites + element_sites[4 * e + row_slot];
        for (uint a = 0; a < 4; ++a) {
          const real weight = site->weight[a] * contact_weight[k];
          const uint other = site->node[a];
          if (weight == 0) continue;
          global const real* block = slot_block(&contacts, e, row_slot, column_slot);
          if (other == r)
            sum0 += weight * vload3(0, block), sum1 += weight * vload3(0, block + 12),
                sum2 += weight * vload3(0, block + 24);
          else if (r == c && node_group[other] == node_group[c] &&
                   !has_block(other, c, block_first, block_last, row))
            left_out += fabs(weight) * size_of(block);
        }
      }
    }
  }
  vstore3(sum0, 0, found + NUMBERS * item);
  vstore3(sum1, 1, found + NUMBERS * item);
  vstore3(sum2, 2, found + NUMBERS * item);
  found[NUMBERS * item + 9] = left_out;
  barrier(CLK_LOCAL_MEM_FENCE);
  const uint hole = i < n ? 3 * n_holes : get_global_id(0) - SHARES * n;  // and its column
  if (hole < 3 * n_holes)
    vstore3((real3)(0), 0, panels + hole_place[hole / 3] + (size_t)(hole % 3) * hole_stride[hole / 3]);
  // nine work-items go on, each with one number of the block
  if (i >= n || share >= 9) return;
  const uint q = share / 3, p = share % 3;  // row, column
  const uint n_found = n_contacts > 0 ? SHARES : 0;
  real sum = source[i] == NO_BLOCK ? 0 : matrix_blocks[9 * (size_t)source[i] + share];
  for (uint k = 0; k < n_found; ++k) {
    local const real* one = found + NUMBERS * (item - share + k);
    sum += one[share];
    if (q == p) sum += one[9];
  }
  const uint s = stride[i] & ~IS_TRANSPOSED;
  panels[place[i] + (stride[i] & IS_TRANSPOSED ? q * s + p : q + p * s)] = sum;
}
