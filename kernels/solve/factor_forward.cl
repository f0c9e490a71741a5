// The forward half of a solve with the factor, by one front: it adds what its children leave to its unknowns and
// eliminates its pivots.
#ifndef PVG_SOLVE_FACTOR_FORWARD_CL
#define PVG_SOLVE_FACTOR_FORWARD_CL
#include "shared/real.h"
#include "solve/factor_front.h"
#define ITEMS FACTOR_ITEMS
#define WIDTH FACTOR_WIDTH

// A diagonal block of the factor, row-major, with zeros where the front ends; the upper triangle is not used.
static inline void load_diagonal(const uint item, global const real* panel, const uint n, const uint first,
                                 const uint width, local real* diagonal) {
  for (uint k = item; k < WIDTH * WIDTH; k += ITEMS) {
    const uint r = k / WIDTH, c = k % WIDTH;
    diagonal[k] = r < width && c < width ? panel[first + r + (size_t)(first + c) * n] : 0;
  }
}

// x = L^-1 x and x = L^-T x with such a block, by one work-item; of fixed length, so that compilers unroll them
static inline void solve_lower(local const real* diagonal, local real* x) {
  real solved[WIDTH];
  for (uint c = 0; c < WIDTH; ++c) {
    real value = x[c];
    for (uint k = 0; k < c; ++k) value -= diagonal[c * WIDTH + k] * solved[k];
    solved[c] = value * diagonal[c * WIDTH + c];
  }
  for (uint c = 0; c < WIDTH; ++c) x[c] = solved[c];
}

static inline void solve_upper(local const real* diagonal, local real* x) {
  real solved[WIDTH];
  for (uint c = WIDTH; c-- > 0;) {
    real value = x[c];
    for (uint k = WIDTH; --k > c;) value -= diagonal[k * WIDTH + c] * solved[k];
    solved[c] = value * diagonal[c * WIDTH + c];
  }
  for (uint c = 0; c < WIDTH; ++c) x[c] = solved[c];
}

// Solves forward by one front whose children are done.  sign: of the residual
// diagonal: [WIDTH x WIDTH], x: [WIDTH];  the rest as in solve/factor_solve.cl
static inline void forward_front(const uint item, const FactorFront front, global const FactorFront* restrict fronts,
                                 global const uint* restrict children, global const uint* restrict places,
                                 global const uint* restrict nodes, global const real* panels, const real sign,
                                 global const real* restrict residual, global real* vectors, local real* diagonal,
                                 local real* x) {
  const uint n = front.n_pivots + front.n_rows;
  global const real* panel = panels + front.panel;
  global real* v = vectors + front.vector;
  for (uint k = item; k < n; k += ITEMS)
    v[k] = k < front.n_pivots ? sign * residual[3 * (size_t)nodes[front.nodes + k / 3] + k % 3] : 0;
  barrier(CLK_GLOBAL_MEM_FENCE);
  for (uint c = front.first_child; c < front.last_child; ++c) {
    const FactorFront child = fronts[children[c]];
    for (uint k = item; k < child.n_rows; k += ITEMS)
      v[3 * places[child.places + k / 3] + k % 3] += vectors[child.vector + child.n_pivots + k];
    barrier(CLK_GLOBAL_MEM_FENCE);
  }
  for (uint first = 0; first < front.n_pivots; first += WIDTH) {
    const uint width = min(WIDTH, front.n_pivots - first);
    load_diagonal(item, panel, n, first, width, diagonal);
    if (item < WIDTH) x[item] = item < width ? v[first + item] : 0;
    barrier(CLK_LOCAL_MEM_FENCE);
    if (item == 0) solve_lower(diagonal, x);
    barrier(CLK_LOCAL_MEM_FENCE);
    if (item < width) v[first + item] = x[item];
    for (uint r = first + width + item; r < n; r += ITEMS) {
      real sum = 0;
      for (uint c = 0; c < width; ++c) sum += panel[r + (size_t)(first + c) * n] * x[c];
      v[r] -= sum;
    }
    barrier(CLK_LOCAL_MEM_FENCE | CLK_GLOBAL_MEM_FENCE);
  }
}

#endif
