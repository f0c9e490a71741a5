#include "host/physics/linear/front_kernels.hpp"

#include <algorithm>
#include <cmath>

// one function for each kind of processor, chosen when the program starts
#if defined(__x86_64__) && defined(__gnu_linux__)
#define FOR_EACH_PROCESSOR __attribute__((target_clones("fma", "default")))
#define FOR_WIDE_PROCESSOR __attribute__((target("avx512f,fma")))
#define HAS_WIDE_PROCESSOR __builtin_cpu_supports("avx512f")
#else
#define FOR_EACH_PROCESSOR
#define FOR_WIDE_PROCESSOR
#define HAS_WIDE_PROCESSOR false
#endif
#define INLINE inline __attribute__((always_inline))

namespace pvg {
namespace {

using Vector = double __attribute__((vector_size(32), may_alias));                   // four rows
using WideVector = double __attribute__((vector_size(64), may_alias, aligned(32)));  // eight
constexpr int LANES = 4, BLOCK = 12;  // BLOCK: columns factored at once, four nodes

template <class AnyVector>
INLINE void load(AnyVector& v, const double* from) {
  v = *reinterpret_cast<const AnyVector*>(from);
}
template <class AnyVector>
INLINE void store(double* to, const AnyVector& v) {
  *reinterpret_cast<AnyVector*>(to) = v;
}

// A and B of a product A B^T: rows lie next to each other, columns (of the depth) a stride apart.
struct Factors {
  const double *a, *b;
  int a_stride, b_stride;
  int b_next;  // from three rows of B to the next three
  int depth;
};

// C[rows x 3] -= A[rows x depth] B[3 x depth]^T for N vectors of rows
// IS_SET: C is taken as zero before
template <int N, bool IS_SET, class AnyVector>
INLINE void multiply_tile(double* c, int c_stride, const Factors& f, const double* b) {
  constexpr int N_LANES = sizeof(AnyVector) / sizeof(double);
  const double* a = f.a;
  AnyVector sum[3][N] = {};
  for (int j = 0; j < 3 && !IS_SET; ++j)
    for (int i = 0; i < N; ++i) load(sum[j][i], c + j * c_stride + N_LANES * i);
  for (int k = 0; k < f.depth; ++k, a += f.a_stride, b += f.b_stride)
    for (int i = 0; i < N; ++i) {
      AnyVector rows;
      load(rows, a + N_LANES * i);
      for (int j = 0; j < 3; ++j) sum[j][i] -= rows * b[j];
    }
  for (int j = 0; j < 3; ++j)
    for (int i = 0; i < N; ++i) store(c + j * c_stride + N_LANES * i, sum[j][i]);
}

// the same for n_rows of at most ROWS (a multiple of LANES) and n_columns (of 3)
template <bool IS_WIDE>
constexpr int ROWS = IS_WIDE ? 32 : 16;
template <bool IS_SET, bool IS_WIDE>
INLINE void multiply_rows(double* c, int c_stride, const Factors& f, int n_rows, int n_columns) {
  const double* b = f.b;
  for (int j = 0; j < n_columns; j += 3, b += f.b_next) {
    double* tile = c + j * c_stride;
    if (IS_WIDE && n_rows == ROWS<true>) {
      multiply_tile<4, IS_SET, WideVector>(tile, c_stride, f, b);
      continue;
    }
    Factors rest = f;
    int i = 0;
    for (; i + 4 * LANES <= n_rows; i += 4 * LANES, rest.a += 4 * LANES)
      multiply_tile<4, IS_SET, Vector>(tile + i, c_stride, rest, b);
    if (n_rows - i == 3 * LANES) multiply_tile<3, IS_SET, Vector>(tile + i, c_stride, rest, b);
    if (n_rows - i == 2 * LANES) multiply_tile<2, IS_SET, Vector>(tile + i, c_stride, rest, b);
    if (n_rows - i == 1 * LANES) multiply_tile<1, IS_SET, Vector>(tile + i, c_stride, rest, b);
  }
}

constexpr int DEPTH = 192, COLUMNS = 96;  // of a packed piece: three rows of B in the first cache, all in the second

// The columns [first_column, first_column + n_columns) of multiply() below, packed: each column of a large panel lies
// on a page of its own, and a tile walks over all of them.
template <bool IS_SET, bool IS_WIDE>
INLINE void multiply_packed(double* c, int c_stride, const double* a, const double* b, int stride, int depth,
                            int n_rows, int first_column, int n_columns) {
  alignas(64) double a_piece[DEPTH * ROWS<IS_WIDE>];
  alignas(64) double b_piece[DEPTH * COLUMNS];
  for (int j = 0; j < n_columns; j += 3)
    for (int k = 0; k < depth; ++k)
      for (int r = 0; r < 3; ++r) b_piece[j * depth + 3 * k + r] = b[first_column + j + r + k * stride];
  for (int i = first_column / ROWS<IS_WIDE> * ROWS<IS_WIDE>; i < n_rows; i += ROWS<IS_WIDE>) {
    const int n_here = std::min(n_rows - i, ROWS<IS_WIDE>);
    const int n_lower = std::min(n_columns, i + n_here - first_column);
    for (int k = 0; k < depth; ++k)
      for (int r = 0; r < n_here; ++r) a_piece[k * ROWS<IS_WIDE> + r] = a[i + r + k * stride];
    multiply_rows<IS_SET, IS_WIDE>(c + i + first_column * c_stride, c_stride,
                                   {a_piece, b_piece, ROWS<IS_WIDE>, 3, 3 * depth, depth}, n_here, n_lower);
  }
}

// C -= A B^T, or = with IS_SET, for n_rows (a multiple of LANES) x n_columns (of 3), lower triangle: column j from row
// j on
template <bool IS_SET>
INLINE void multiply_few(double* c, int c_stride, const double* a, const double* b, int stride, int depth, int n_rows,
                         int n_columns) {
  for (int i = 0; i < n_rows; i += ROWS<false>) {
    const int n_here = std::min(n_rows - i, ROWS<false>);
    multiply_rows<IS_SET, false>(c + i, c_stride, {a + i, b, stride, stride, 3, depth}, n_here,
                                 std::min(n_columns, i + n_here));
  }
}

// the same where packing pays
template <bool IS_SET, bool IS_WIDE>
INLINE void multiply(double* c, int c_stride, const double* a, const double* b, int stride, int depth, int n_rows,
                     int n_columns) {
  if (depth < 48 || n_rows < 64) return multiply_few<IS_SET>(c, c_stride, a, b, stride, depth, n_rows, n_columns);
  for (int k = 0; k < depth; k += DEPTH)
    for (int j = 0; j < n_columns; j += COLUMNS) {
      const double *a_from = a + k * stride, *b_from = b + k * stride;
      const int depth_here = std::min(depth - k, DEPTH), n_here = std::min(n_columns - j, COLUMNS);
      if (IS_SET && k == 0)
        multiply_packed<true, IS_WIDE>(c, c_stride, a_from, b_from, stride, depth_here, n_rows, j, n_here);
      else
        multiply_packed<false, IS_WIDE>(c, c_stride, a_from, b_from, stride, depth_here, n_rows, j, n_here);
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

// Left-looking over pieces of COLUMNS and, in each, over blocks of BLOCK columns: each is updated by all before it at
// once, so that the sums stay in registers.
template <bool IS_WIDE>
INLINE bool factor(const Panel& panel) {
  const int stride = panel.stride;
  for (int first = 0; first < panel.n_pivots; first += BLOCK) {
    const int n = std::min(BLOCK, panel.n_pivots - first), piece = first / COLUMNS * COLUMNS;
    double* diagonal = panel.values + first + first * stride;
    if (first == piece && first > 0) {
      const double* before = panel.values + first;
      multiply<false, IS_WIDE>(diagonal, stride, before, before, stride, first, panel.last_row - first,
                               std::min(COLUMNS, panel.n_pivots - first));
    } else if (first > piece) {
      const double* before = panel.values + first + piece * stride;
      multiply_few<false>(diagonal, stride, before, before, stride, first - piece, panel.last_row - first, n);
    }
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

template <bool IS_WIDE>
INLINE void multiply_rows_below(const Panel& panel, double* update, int update_stride) {
  const double* rows = panel.values + panel.first_row;
  multiply<true, IS_WIDE>(update, update_stride, rows, rows, panel.stride, panel.n_pivots,
                          panel.last_row - panel.first_row, panel.n_rows);
}

FOR_WIDE_PROCESSOR bool factor_wide(const Panel& panel) { return factor<true>(panel); }
FOR_EACH_PROCESSOR bool factor_narrow(const Panel& panel) { return factor<false>(panel); }
FOR_WIDE_PROCESSOR void multiply_wide(const Panel& panel, double* update, int update_stride) {
  multiply_rows_below<true>(panel, update, update_stride);
}
FOR_EACH_PROCESSOR void multiply_narrow(const Panel& panel, double* update, int update_stride) {
  multiply_rows_below<false>(panel, update, update_stride);
}

}  // namespace

bool factor_panel(const Panel& panel) { return HAS_WIDE_PROCESSOR ? factor_wide(panel) : factor_narrow(panel); }

void set_negative_outer_product(const Panel& panel, double* update, int update_stride) {
  HAS_WIDE_PROCESSOR ? multiply_wide(panel, update, update_stride) : multiply_narrow(panel, update, update_stride);
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
