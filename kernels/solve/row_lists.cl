// What a node gets from the rows of elements: sum_k weight_k row_k over its list (solve/node_rows.cl). A node that many
// elements touch, such as those of a rigid body in contact, has a long list, which its whole work-group sums in an order
// that depends on the list alone; a short one is its own work-item's.
#ifndef PVG_SOLVE_ROW_LISTS_CL
#define PVG_SOLVE_ROW_LISTS_CL
#include "shared/lanes.h"
#include "solve/group_sum.cl"

// entries of the longest list that its own work-item sums. Where work-items take turns, sharing gains nothing.
#ifndef LONGEST_OWN_LIST
#if N_LANES > 1
#define LONGEST_OWN_LIST 0xffffffffu
#else
#define LONGEST_OWN_LIST 32u
#endif
#endif

// offset: [n_nodes + 1] into row and weight;  rows: [n_rows x 3]
typedef struct {
  global const uint *offset, *row;
  global const real *weight, *rows;
} RowLists;

// of a work-group
typedef struct {
  uint has_any, is_long[ITEMS];
  real parts[3 * ITEMS], eights[3 * EIGHTS];
} LongLists;

static inline uint length_of_list(const RowLists* lists, const uint node) {
  return lists->offset[node + 1] - lists->offset[node];
}

// weight_k row_k
static inline real3 row_of_list(const RowLists* lists, const uint k) {
  return lists->weight[k] * vload3(lists->row[k], lists->rows);
}

// sum + the node's list, unless it is a long one
static inline real3 add_short_list(const RowLists* lists, const uint node, real3 sum) {
  if (length_of_list(lists, node) > LONGEST_OWN_LIST) return sum;
  for (uint k = lists->offset[node]; k < lists->offset[node + 1]; ++k)
    sum += row_of_list(lists, k);
  return sum;
}

// y_i += the lists that add_short_list left out, for the work-group's nodes from `begin` to `end`, at most 64. All of its
// work-items call this, after they have written y.
static inline void add_long_lists(const RowLists* lists, const uint begin, const uint end,
                                  global const uint* restrict is_fixed, global real* y, local LongLists* shared) {
  if (LONGEST_OWN_LIST == 0xffffffffu) return;
  const uint item = get_local_id(0), own = begin + item;
  if (item == 0) shared->has_any = 0;
  barrier(CLK_LOCAL_MEM_FENCE);
  const bool is_own_long = own < end && !is_fixed[own] && length_of_list(lists, own) > LONGEST_OWN_LIST;
  shared->is_long[item] = is_own_long;
  if (is_own_long) shared->has_any = 1;
  barrier(CLK_LOCAL_MEM_FENCE | CLK_GLOBAL_MEM_FENCE);
  for (uint node = 0; node < (shared->has_any ? ITEMS : 0); ++node) {
    real3 part = (real3)(0);
    const uint first = shared->is_long[node] ? lists->offset[begin + node] : 0;
    const uint last = shared->is_long[node] ? lists->offset[begin + node + 1] : 0;
    uint k = first + item;
    for (; k + 3 * ITEMS < last; k += 4 * ITEMS) {  // fetched together
      const real3 a = row_of_list(lists, k), b = row_of_list(lists, k + ITEMS);
      const real3 c = row_of_list(lists, k + 2 * ITEMS), d = row_of_list(lists, k + 3 * ITEMS);
      part += (a + b) + (c + d);
    }
    for (; k < last; k += ITEMS) part += row_of_list(lists, k);
    vstore3(part, item, shared->parts);
    barrier(CLK_LOCAL_MEM_FENCE);
    if (item < 3 * EIGHTS) {
      real sum = 0;
      for (uint k = 0; k < ITEMS / EIGHTS; ++k) sum += shared->parts[3 * (item / 3 * (ITEMS / EIGHTS) + k) + item % 3];
      shared->eights[item] = sum;
    }
    barrier(CLK_LOCAL_MEM_FENCE);
    if (item < 3 && first < last) {
      real sum = y[3 * (size_t)(begin + node) + item];
      for (uint k = 0; k < EIGHTS; ++k) sum += shared->eights[3 * k + item];
      y[3 * (size_t)(begin + node) + item] = sum;
    }
  }
  barrier(CLK_GLOBAL_MEM_FENCE);
}

#endif
