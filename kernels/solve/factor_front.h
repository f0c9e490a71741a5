// One supernode of the sparse Cholesky factor on the device. Its front is a dense matrix over n = n_pivots + n_rows
// unknowns, of which the first n_pivots are eliminated:
//   panel   [n x n_pivots]     the factor's columns; of the diagonal entries their reciprocals
//   update  [n_rows x n_rows]  what the others pass to the parent
// both column-major, lower triangles.
#ifndef PVG_SOLVE_FACTOR_FRONT_H
#define PVG_SOLVE_FACTOR_FRONT_H
#include "shared/types.h"
#define FACTOR_ITEMS 256u  // work-items of a task: many, for each waits long for its numbers
#define FACTOR_WIDTH 12u   // columns that are eliminated together
SHARED_BEGIN
typedef struct {
  u32 n_pivots, n_rows;         // numbers, three for each node
  u32 panel, update, vector;    // where these begin, in numbers; vector: of a solve [n]
  u32 nodes;                    // where the list of its n / 3 nodes begins
  u32 places;                   // where the list of its n_rows / 3 places in the parent's front begins
  u32 first_child, last_child;  // in the list of children
  u32 parent;                   // its front; NO_FRONT for a root
  u32 group;
  u32 pad_;
} FactorFront;
SHARED_SIZE(FactorFront, 48);
SHARED_END
#endif
