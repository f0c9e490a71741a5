#include "host/physics/front_kernels.hpp"

#include <algorithm>
#include <cmath>

// one function for each kind of processor, chosen when the program starts
#if defined(__x86_64__) && defined(__gnu_linux__)
#define FOR_EACH_PROCESSOR __attribute__((target_clones("fma", "default")))
#else
#define FOR_EACH_PROCESSOR
#endif
#define INLINE inline __attribute__((always_inline))

namespace pvg {
namespace {

using Vector = double __attribute__((vector_size(32), may_alias));  // four rows
constexpr int LANES = 4, BLOCK = 12;                                // BLOCK: columns factored at once, four nodes

INLINE void load(Vector& v, const double* from) { v = *reinterpret_cast<const Vector*>(from); }
INLINE void store(double* to, const Vector& v) { *reinterpret_cast<Vector*>(to) = v; }

// C[rows x 3] -= A[rows x depth] B[3 x depth]^T with rows = LANES N; A and B have the panel's stride
// IS_SET: C is taken as zero before
template <int N, bool IS_SET>
INLINE void multiply_tile(double* c, int c_stride, const double* a, const double* b, int stride, int depth) {
  Vector sum[3][N] = {};
  for (int j = 0; j < 3 && !IS_SET; ++j)
    for (int i = 0; i < N; ++i) load(sum[j][i], c + j * c_stride + LANES * i);
  for (int k = 0; k < depth; ++k, a += stride, b += stride)
    for (int i = 0; i < N; ++i) {
      Vector rows;
      load(rows, a + LANES * i);
      for (int j = 0; j < 3; ++j) sum[j][i] -= rows * b[j];
    }
  for (int j = 0; j < 3; ++j)
    for (int i = 0; i < N; ++i) store(c + j * c_stride + LANES * i, sum[j][i]);
}

// C -= A B^T, or = with IS_SET, for n_rows (a multiple of LANES) x n_columns (of 3), lower triangle: column j from row
// j on
template <bool IS_SET>
INLINE void multiply(double* c, int c_stride, const double* a, const double* b, int stride, int depth, int n_rows,
                     int n_columns) {
  for (int i = 0; i < n_rows; i += 4 * LANES) {
    const int n_here = std::min(n_rows - i, 4 * LANES) / LANES;
    for (int j = 0; j < std::min(n_columns, i + LANES * n_here); j += 3) {
      double* tile = c + i + j * c_stride;
      if (n_here == 4) multiply_tile<4, IS_SET>(tile, c_stride, a + i, b + j, stride, depth);
      if (n_here == 3) multiply_tile<3, IS_SET>(tile, c_stride, a + i, b + j, stride, depth);
      if (n_here == 2) multiply_tile<2, IS_SET>(tile, c_stride, a + i, b + j, stride, depth);
      if (n_here == 1) multiply_tile<1, IS_SET>(tile, c_stride, a + i, b + j, stride, depth);
    }
  }
}

// Cholesky of the lower triangle in place; inverse: 1 / diagonal
INLINE bool factor_diagonal(double* a, int stride, int n, double* inverse) {
  for (int k = 0; k < n; ++k) {
    double pivot = a[k + k * stride];
    for (int d = 0; d < k; ++d) pivot -= a[k + d * stride] * a[k + d * stride];
    if (!(pivot > 0 && std::isfinite(pivot))) return false;
    a[k + k * stride] = std::sqrt(pivot);
    inverse[k] = 1 / a[k + k * stride];
    for (int i = k + 1; i < n; ++i) {
      double sum = a[i + k * stride];
      for (int d = 0; d < k; ++d) sum -= a[i + d * stride] * a[k + d * stride];
      a[i + k * stride] = sum * inverse[k];
    }
  }
  return true;
}

// X L^T = B for N columns in place, rows [0, n_rows), n_rows a multiple of LANES
template <int N>
INLINE void solve_rows(double* b, int stride, int n_rows, const double* lower, const double* inverse) {
  for (int i = 0; i < n_rows; i += LANES) {
    Vector x[N];
    for (int c = 0; c < N; ++c) load(x[c], b + i + c * stride);
    for (int c = 0; c < N; ++c) {
      x[c] *= inverse[c];
      for (int d = c + 1; d < N; ++d) x[d] -= x[c] * lower[d + c * stride];
    }
    for (int c = 0; c < N; ++c) store(b + i + c * stride, x[c]);
  }
}

// x[rows] -= L[rows x N] y
template <int N>
INLINE void subtract_columns(double* x, const double* lower, int stride, int n_rows, const double* y) {
  for (int i = 0; i < n_rows; i += LANES) {
    Vector sum;
    load(sum, x + i);
    for (int c = 0; c < N; ++c) {
      Vector rows;
      load(rows, lower + i + c * stride);
      sum -= rows * y[c];
    }
    store(x + i, sum);
  }
}

// y[N] -= L[rows x N]^T x
template <int N>
INLINE void subtract_dot_products(double* y, const double* lower, int stride, int n_rows, const double* x) {
  Vector sum[N] = {};
  for (int i = 0; i < n_rows; i += LANES) {
    Vector here;
    load(here, x + i);
    for (int c = 0; c < N; ++c) {
      Vector rows;
      load(rows, lower + i + c * stride);
      sum[c] += rows * here;
    }
  }
  for (int c = 0; c < N; ++c) y[c] -= (sum[c][0] + sum[c][1]) + (sum[c][2] + sum[c][3]);
}

}  // namespace

// left-looking over blocks of columns: each is updated by all before it at once, so that the sums stay in registers
FOR_EACH_PROCESSOR bool factor_panel(const Panel& panel) {
  const int stride = panel.stride;
  for (int first = 0; first < panel.n_pivots; first += BLOCK) {
    const int n = std::min(BLOCK, panel.n_pivots - first);
    double* diagonal = panel.values + first + first * stride;
    const double* before = panel.values + first;
    if (first > 0) multiply<false>(diagonal, stride, before, before, stride, first, panel.last_row - first, n);
    double inverse[BLOCK];
    if (!factor_diagonal(diagonal, stride, n, inverse)) return false;
    const int below = first + n == panel.n_pivots ? panel.first_row : first + n, n_rows = panel.last_row - below;
    double* rows = panel.values + below + first * stride;
    if (n == 12) solve_rows<12>(rows, stride, n_rows, diagonal, inverse);
    if (n == 9) solve_rows<9>(rows, stride, n_rows, diagonal, inverse);
    if (n == 6) solve_rows<6>(rows, stride, n_rows, diagonal, inverse);
    if (n == 3) solve_rows<3>(rows, stride, n_rows, diagonal, inverse);
  }
  return true;
}

FOR_EACH_PROCESSOR void set_negative_outer_product(const Panel& panel, double* update, int update_stride) {
  const double* rows = panel.values + panel.first_row;
  multiply<true>(update, update_stride, rows, rows, panel.stride, panel.n_pivots, panel.last_row - panel.first_row,
                 panel.n_rows);
}

FOR_EACH_PROCESSOR void solve_forward(const Panel& panel, double* x) {
  const int stride = panel.stride;
  for (int first = 0; first < panel.n_pivots; first += BLOCK) {
    const int n = std::min(BLOCK, panel.n_pivots - first);
    const double* diagonal = panel.values + first + first * stride;
    double* y = x + first;
    for (int c = 0; c < n; ++c) {
      y[c] /= diagonal[c + c * stride];
      for (int i = c + 1; i < n; ++i) y[i] -= diagonal[i + c * stride] * y[c];
    }
    const int below = first + n == panel.n_pivots ? panel.first_row : first + n, n_rows = panel.last_row - below;
    const double* rows = panel.values + below + first * stride;
    if (n == 12) subtract_columns<12>(x + below, rows, stride, n_rows, y);
    if (n == 9) subtract_columns<9>(x + below, rows, stride, n_rows, y);
    if (n == 6) subtract_columns<6>(x + below, rows, stride, n_rows, y);
    if (n == 3) subtract_columns<3>(x + below, rows, stride, n_rows, y);
  }
}

FOR_EACH_PROCESSOR void solve_backward(const Panel& panel, double* x) {
  const int stride = panel.stride;
  for (int first = (panel.n_pivots - 1) / BLOCK * BLOCK; first >= 0; first -= BLOCK) {
    const int n = std::min(BLOCK, panel.n_pivots - first);
    const double* diagonal = panel.values + first + first * stride;
    double* y = x + first;
    const int below = first + n == panel.n_pivots ? panel.first_row : first + n, n_rows = panel.last_row - below;
    const double* rows = panel.values + below + first * stride;
    if (n == 12) subtract_dot_products<12>(y, rows, stride, n_rows, x + below);
    if (n == 9) subtract_dot_products<9>(y, rows, stride, n_rows, x + below);
    if (n == 6) subtract_dot_products<6>(y, rows, stride, n_rows, x + below);
    if (n == 3) subtract_dot_products<3>(y, rows, stride, n_rows, x + below);
    for (int c = n - 1; c >= 0; --c) {
      for (int i = c + 1; i < n; ++i) y[c] -= diagonal[i + c * stride] * y[i];
      y[c] /= diagonal[c + c * stride];
    }
  }
}

FOR_EACH_PROCESSOR void add_runs(double* to, const double* from, const Run* runs, std::size_t n_runs) {
  for (std::size_t k = 0; k < n_runs; ++k) {
    const Run run = runs[k];
    for (int i = 0; i < run.n; ++i) to[run.to + i] += from[run.from + i];
  }
}

}  // namespace pvg
