// Dense kernels of the block Cholesky factor, in double or single precision: one panel of the factor is
//   [ L11 ]  n_pivots columns, lower triangle         rows [0, n_pivots)
//   [ L21 ]  the rows below that it couples           rows [first_row, stride)
// column-major; first_row and stride are rounded up so that every column starts a cache line, rows in between are zero.
// Vectors of 32 bytes: two SSE2 halves, or one AVX2 register with fused multiply-add where the processor has it.
#pragma once
#include <cstddef>

namespace pvg {

template <class Real>
struct Panel {
  Real* values = nullptr;  // [stride x n_pivots]
  int stride = 0;          // a multiple of a cache line
  int n_pivots = 0;        // a multiple of 3
  int first_row = 0;       // n_pivots rounded up to a multiple of 4
  int n_rows = 0;          // of L21, a multiple of 3
  int last_row = 0;        // end of L21 rounded up to a multiple of 4, <= stride
};

// Real is double or float.

// While it lives, this thread takes numbers of less than 1e-38 for zero where the processor can: entries that fill in
// decay with the distance of their nodes, in single precision to numbers with which it is a hundred times slower.
class SubnormalsAreZero {
 public:
  SubnormalsAreZero();
  ~SubnormalsAreZero();
  SubnormalsAreZero(const SubnormalsAreZero&) = delete;
  SubnormalsAreZero& operator=(const SubnormalsAreZero&) = delete;

 private:
  unsigned before_ = 0;
};

// A -> L in place. False where a pivot is not a finite number above the least that it may be; least: [n_pivots]
template <class Real>
bool factor_panel(const Panel<Real>& panel, const Real* least);
// update = -L21 L21^T in the lower triangle; what lies above the diagonal becomes meaningless
// update: [n_rows x n_rows], column-major, n_rows rounded up to a multiple of 4 in its stride, which is one of a cache
// line
template <class Real>
void set_negative_outer_product(const Panel<Real>& panel, Real* update, int update_stride);
// x: [last_row]. forward: x1 = L11^-1 x1, x2 -= L21 x1.  backward: x1 = L11^-T (x1 - L21^T x2)
template <class Real>
void solve_forward(const Panel<Real>& panel, Real* x);
template <class Real>
void solve_backward(const Panel<Real>& panel, Real* x);

// numbers that lie one behind the other in both of two columns
struct Run {
  int from, to, n;
};
// to[run] += from[run] for all runs
template <class Real>
void add_runs(Real* to, const Real* from, const Run* runs, std::size_t n_runs);

}  // namespace pvg
