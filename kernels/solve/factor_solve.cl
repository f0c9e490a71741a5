// x = (L L^T)^-1 r with the factor of solve/factor_fronts.cl. Forward, from the leaves to the roots, a front adds what
// its children leave to its unknowns and eliminates its pivots; backward it takes its parent's unknowns. Tasks are parts
// of the elimination tree as there, larger ones, for a solve takes less.
#include "solve/factor_forward.cl"
#define FORWARD 1u
#define BACKWARD 2u

// n_items: ITEMS for each task from first_task on, then one for each node without group (n_lone)
// parts: FORWARD, BACKWARD or both;  adds: to what is in `preconditioned`
// nodes: of all fronts;  places, children, tasks, group_is_active, failed: as in factor_fronts
// vectors: of all fronts, between the parts;  residual, preconditioned: [n_nodes x 3], zero where there is no factor
kernel __attribute__((reqd_work_group_size(ITEMS, 1, 1))) void factor_solve(
    const uint n_items, const uint first_task, const uint n_tasks, const uint parts, const uint adds, const uint n_lone,
    global const uint* restrict lone_nodes, global const uint* restrict task_first,
    global const uint* restrict task_front, global const FactorFront* restrict fronts,
    global const uint* restrict children, global const uint* restrict places, global const uint* restrict nodes,
    global const uint* restrict group_is_active, global const uint* restrict failed,
    global const real* restrict panels, global const real* restrict residual, global real* vectors,
    global real* restrict preconditioned) {
  local real diagonal[WIDTH * WIDTH], x[WIDTH], partial[WIDTH * ITEMS];
  const uint item = get_local_id(0), group = get_group_id(0);
  const bool is_task = group < n_tasks;
  const uint task = first_task + (is_task ? group : 0);
  const uint lone = (group - n_tasks) * ITEMS + item;
  if (!is_task && lone < n_lone && !adds) vstore3((real3)(0), lone_nodes[lone], preconditioned);
  const uint begin = task_first[task], last = is_task ? task_first[task + 1] : begin;
  const uint own = fronts[task_front[begin]].group;
  const bool is_on = group_is_active[own] && !failed[own];

  const uint forward_end = is_on && (parts & FORWARD) ? last : begin;
  for (uint f = begin; f < forward_end; ++f) {
    forward_front(item, fronts[task_front[f]], fronts, children, places, nodes, panels, 1, residual, vectors, diagonal, x);
  }

  const uint backward_end = is_on && (parts & BACKWARD) ? last : begin;
  for (uint left = backward_end; left > begin; --left) {
    const FactorFront front = fronts[task_front[left - 1]];
    const uint n = front.n_pivots + front.n_rows;
    global const real* panel = panels + front.panel;
    global real* v = vectors + front.vector;
    if (front.n_rows > 0) {
      const uint parent = fronts[front.parent].vector;
      for (uint k = item; k < front.n_rows; k += ITEMS)
        v[front.n_pivots + k] = vectors[parent + 3 * places[front.places + k / 3] + k % 3];
    }
    barrier(CLK_GLOBAL_MEM_FENCE);
    for (uint done = (front.n_pivots + WIDTH - 1) / WIDTH; done > 0; --done) {
      const uint first = (done - 1) * WIDTH, width = min(WIDTH, front.n_pivots - first);
      load_diagonal(item, panel, n, first, width, diagonal);
      for (uint c = 0; c < width; ++c) {
        real sum = 0;
        for (uint r = first + width + item; r < n; r += ITEMS) sum += panel[r + (size_t)(first + c) * n] * v[r];
        partial[c * ITEMS + item] = sum;
      }
      barrier(CLK_LOCAL_MEM_FENCE);
      for (uint half_width = ITEMS / 2; half_width > 0; half_width /= 2) {
        for (uint k = item; k < width * half_width; k += ITEMS) {
          const uint at = k / half_width * ITEMS + k % half_width;
          partial[at] += partial[at + half_width];
        }
        barrier(CLK_LOCAL_MEM_FENCE);
      }
      if (item < WIDTH) x[item] = item < width ? v[first + item] - partial[item * ITEMS] : 0;
      barrier(CLK_LOCAL_MEM_FENCE);
      if (item == 0) solve_upper(diagonal, x);
      barrier(CLK_LOCAL_MEM_FENCE);
      if (item < width) v[first + item] = x[item];
      barrier(CLK_LOCAL_MEM_FENCE | CLK_GLOBAL_MEM_FENCE);
    }
    for (uint k = item; k < front.n_pivots; k += ITEMS) {
      const size_t at = 3 * (size_t)nodes[front.nodes + k / 3] + k % 3;
      preconditioned[at] = adds ? preconditioned[at] + v[k] : v[k];
    }
  }

  const uint cleared_end = !is_on && (parts & BACKWARD) && !adds ? last : begin;
  for (uint f = begin; f < cleared_end; ++f) {
    const FactorFront front = fronts[task_front[f]];
    for (uint k = item; k < front.n_pivots; k += ITEMS)
      preconditioned[3 * (size_t)nodes[front.nodes + k / 3] + k % 3] = 0;
  }
}
