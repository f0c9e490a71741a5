// Dense kernels of the block Cholesky factor: one panel of the factor is
//   [ L11 ]  n_pivots columns, lower triangle         rows [0, n_pivots)
//   [ L21 ]  the rows below that it couples           rows [first_row, stride)
// column-major; first_row and stride are rounded up so that every column starts a cache line, rows in between are zero.
// Vectors of four doubles: two SSE2 halves, or one AVX2 register with fused multiply-add where the processor has it.
#pragma once
#include <cstddef>

namespace pvg {

struct Panel {
  double* values = nullptr;  // [stride x n_pivots]
  int stride = 0;            // a multiple of 8
  int n_pivots = 0;          // a multiple of 3
  int first_row = 0;         // n_pivots rounded up to a multiple of 4
  int n_rows = 0;            // of L21, a multiple of 3
  int last_row = 0;          // end of L21 rounded up to a multiple of 4, <= stride
};

// A -> L in place. False where a pivot is not a positive finite number.
bool factor_panel(const Panel& panel);
// update = -L21 L21^T in the lower triangle; what lies above the diagonal becomes meaningless
// update: [n_rows x n_rows], column-major, n_rows rounded up to a multiple of 4 in its stride, a multiple of 8
void set_negative_outer_product(const Panel& panel, double* update, int update_stride);
// x: [last_row]. forward: x1 = L11^-1 x1, x2 -= L21 x1.  backward: x1 = L11^-T (x1 - L21^T x2)
void solve_forward(const Panel& panel, double* x);
void solve_backward(const Panel& panel, double* x);

// numbers that lie one behind the other in both of two columns
struct Run {
  int from, to, n;
};
// to[run] += from[run] for all runs
void add_runs(double* to, const double* from, const Run* runs, std::size_t n_runs);

}  // namespace pvg
