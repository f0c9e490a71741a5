// The sparse Cholesky factor of symmetric 3 x 3 blocks, multifrontal (Duff, Reid 1983; Liu 1992): a front adds its
// children's updates, eliminates its pivots and leaves an update to its parent. A task is a part of the elimination
// tree, children before parents, and one work-group's own; the tasks of a launch are independent of each other. What is
// added up for a front does not depend on the tasks, so neither do the bits.
#include "solve/factor_forward.cl"

// The 3 x 3 product of rows r.. and c.. over the first `depth` columns; in it column by column.
static inline void product_of_rows(global const real* r, global const real* c, const uint stride, const uint depth,
                                   real3* sum0, real3* sum1, real3* sum2) {
  *sum0 = *sum1 = *sum2 = (real3)(0);
  for (uint k = 0; k < depth; ++k, r += stride, c += stride) {
    const real3 a = vload3(0, r), b = vload3(0, c);
    *sum0 += a * b.x;
    *sum1 += a * b.y;
    *sum2 += a * b.z;
  }
}

// to -= product of rows;  to: 3 x 3, columns `to_stride` apart
static inline void subtract_product(global const real* r, global const real* c, const uint stride, const uint depth,
                                    global real* to, const uint to_stride) {
  real3 sum0, sum1, sum2;
  product_of_rows(r, c, stride, depth, &sum0, &sum1, &sum2);
  vstore3(vload3(0, to) - sum0, 0, to);
  vstore3(vload3(0, to + to_stride) - sum1, 0, to + to_stride);
  vstore3(vload3(0, to + 2 * to_stride) - sum2, 0, to + 2 * to_stride);
}

// Adds a child's update to the front: to the panel's columns, or to the update that it passes on.
static inline void add_update(const uint item, const FactorFront front, const FactorFront child,
                              global const uint* restrict places, global real* panels, global real* updates) {
  const uint n = front.n_pivots + front.n_rows, n_blocks = child.n_rows / 3;
  global const uint* place = places + child.places;
  for (uint k = item; k < n_blocks * n_blocks; k += ITEMS) {
    const uint i = k % n_blocks, j = k / n_blocks;
    if (i < j) continue;
    const uint r = 3 * place[i], c = 3 * place[j];
    global const real* from = updates + child.update + 3 * i + (size_t)(3 * j) * child.n_rows;
    const bool is_pivot = c < front.n_pivots;
    global real* to = is_pivot ? panels + front.panel + r + (size_t)c * n
                               : updates + front.update + (r - front.n_pivots) +
                                     (size_t)(c - front.n_pivots) * front.n_rows;
    const uint stride = is_pivot ? n : front.n_rows;
    for (uint q = 0; q < 3; ++q)
      vstore3(vload3(0, to + q * stride) + vload3(0, from + q * child.n_rows), 0, to + q * stride);
  }
}

// n: work-items, ITEMS for each task from first_task on;  task_first: [n_tasks + 1] into task_front
// children: fronts;  places: of a front's rows in its parent's front, in nodes;  group_is_active, failed: [n_groups];
// failed: 1 where a pivot is not a positive finite number
// solves: each front also solves forward, for a residual of -gradient [n_nodes x 3];  nodes, vectors: as in
// solve/factor_solve.cl
kernel __attribute__((reqd_work_group_size(ITEMS, 1, 1))) void factor_fronts(
    const uint n_items, const uint first_task, global const uint* restrict task_first,
    global const uint* restrict task_front, global const FactorFront* restrict fronts,
    global const uint* restrict children, global const uint* restrict places,
    global const uint* restrict group_is_active, global real* panels, global real* updates, global uint* failed,
    const uint solves, global const uint* restrict nodes, global const real* restrict gradient, global real* vectors) {
  local real diagonal[WIDTH * WIDTH];  // row-major, lower triangle
  local real x[WIDTH], reciprocals[WIDTH];
  const uint task = first_task + get_group_id(0), item = get_local_id(0);
  const uint begin = task_first[task];
  const uint end = group_is_active[fronts[task_front[begin]].group] ? task_first[task + 1] : begin;
  for (uint f = begin; f < end; ++f) {
    const FactorFront front = fronts[task_front[f]];
    const uint n = front.n_pivots + front.n_rows;
    global real* panel = panels + front.panel;
    global real* update = updates + front.update;
    for (uint k = item; k < front.n_rows * front.n_rows; k += ITEMS) update[k] = 0;
    barrier(CLK_GLOBAL_MEM_FENCE);
    for (uint k = front.first_child; k < front.last_child; ++k) {
      add_update(item, front, fronts[children[k]], places, panels, updates);
      barrier(CLK_GLOBAL_MEM_FENCE);
    }
    for (uint first = 0; first < front.n_pivots; first += WIDTH) {
      const uint width = min(WIDTH, front.n_pivots - first), n_below = (n - first) / 3;
      for (uint k = item; k < n_below * (width / 3); k += ITEMS) {
        const uint r = first + 3 * (k % n_below), c = first + 3 * (k / n_below);
        if (r >= c) subtract_product(panel + r, panel + c, n, first, panel + r + (size_t)c * n, n);
      }
      barrier(CLK_GLOBAL_MEM_FENCE);
      load_diagonal(item, panel, n, first, width, diagonal);
      barrier(CLK_LOCAL_MEM_FENCE);
      // each work-item has one number of the block; its columns are divided by the roots of their pivots at the end
      const uint row = item / WIDTH, column = item % WIDTH;
      for (uint p = 0; p < width; ++p) {
        real pivot = diagonal[p * WIDTH + p];
        const bool is_good = pivot > 0 && isfinite(pivot);
        if (!is_good) pivot = 1;
        if (!is_good && item == 0) failed[front.group] = 1;
        const real reciprocal = 1 / sqrt(pivot);
        if (item == 0) reciprocals[p] = reciprocal;
        if (p < column && column <= row && row < width)
          diagonal[row * WIDTH + column] -=
              (diagonal[row * WIDTH + p] * reciprocal) * (diagonal[column * WIDTH + p] * reciprocal);
        barrier(CLK_LOCAL_MEM_FENCE);
      }
      if (column <= row && row < width)
        diagonal[row * WIDTH + column] =
            row == column ? reciprocals[row] : diagonal[row * WIDTH + column] * reciprocals[column];
      barrier(CLK_LOCAL_MEM_FENCE);
      for (uint k = item; k < width * width; k += ITEMS)
        if (k / width >= k % width)
          panel[first + k / width + (size_t)(first + k % width) * n] = diagonal[k / width * WIDTH + k % width];
      for (uint r = first + width + item; r < n; r += ITEMS) {
        real row[WIDTH];
        for (uint c = 0; c < width; ++c) {
          real value = panel[r + (size_t)(first + c) * n];
          for (uint k = 0; k < c; ++k) value -= row[k] * diagonal[c * WIDTH + k];
          row[c] = value * diagonal[c * WIDTH + c];
          panel[r + (size_t)(first + c) * n] = row[c];
        }
      }
      barrier(CLK_LOCAL_MEM_FENCE | CLK_GLOBAL_MEM_FENCE);
    }
    const uint n_blocks = front.n_rows / 3;
    for (uint k = item; k < n_blocks * n_blocks; k += ITEMS) {
      const uint i = k % n_blocks, j = k / n_blocks;
      if (i >= j)
        subtract_product(panel + front.n_pivots + 3 * i, panel + front.n_pivots + 3 * j, n, front.n_pivots,
                         update + 3 * i + (size_t)(3 * j) * front.n_rows, front.n_rows);
    }
    barrier(CLK_GLOBAL_MEM_FENCE);
    if (solves)
      forward_front(item, front, fronts, children, places, nodes, panels, -1, gradient, vectors, diagonal, x);
  }
}
