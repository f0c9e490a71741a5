// The factor of a front and the update that it leaves (front_kernels.hpp).
#include <algorithm>
#include <cmath>

#include "host/physics/linear/front_kernels.hpp"
#include "host/physics/linear/front_vectors.hpp"

namespace pvg {
namespace {

// A and B of a product A B^T: rows lie next to each other, columns (of the depth) a stride apart.
template <class Real>
struct Factors {
  const Real *a, *b;
  int a_stride, b_stride;
  int b_next;  // from three rows of B to the next three
  int depth;
};

// C[rows x 3] -= A[rows x depth] B[3 x depth]^T for N vectors of rows. The product is summed by itself: what it takes
// from C cancels most of it in the end, and to round C at each turn would cost single precision two digits.
// IS_SET: C is taken as zero before
template <int N, bool IS_SET, int N_LANES, class Real>
INLINE void multiply_tile(Real* c, int c_stride, const Factors<Real>& f, const Real* b) {
  using Rows = typename VectorOf<Real, N_LANES>::Rows;
  const Real* a = f.a;
  Rows sum[3][N] = {};
  for (int k = 0; k < f.depth; ++k, a += f.a_stride, b += f.b_stride)
    for (int i = 0; i < N; ++i) {
      Rows rows;
      load(rows, a + N_LANES * i);
      for (int j = 0; j < 3; ++j) sum[j][i] -= rows * b[j];
    }
  for (int j = 0; j < 3; ++j)
    for (int i = 0; i < N; ++i) {
      Rows before = {};
      if (!IS_SET) load(before, c + j * c_stride + N_LANES * i);
      store(c + j * c_stride + N_LANES * i, before + sum[j][i]);
    }
}

// the same for n_rows of at most ROWS (a multiple of GRAIN) and n_columns (of 3)
template <bool IS_WIDE, class Real>
constexpr int ROWS = 4 * (IS_WIDE ? WIDE_LANES<Real> : LANES<Real>);
template <bool IS_SET, bool IS_WIDE, class Real>
INLINE void multiply_rows(Real* c, int c_stride, const Factors<Real>& f, int n_rows, int n_columns) {
  constexpr int N_LANES = LANES<Real>;
  const Real* b = f.b;
  for (int j = 0; j < n_columns; j += 3, b += f.b_next) {
    Real* tile = c + j * c_stride;
    if (IS_WIDE && n_rows == ROWS<true, Real>) {
      multiply_tile<4, IS_SET, WIDE_LANES<Real>>(tile, c_stride, f, b);
      continue;
    }
    Factors<Real> rest = f;
    int i = 0;
    for (; i + 4 * N_LANES <= n_rows; i += 4 * N_LANES, rest.a += 4 * N_LANES)
      multiply_tile<4, IS_SET, N_LANES>(tile + i, c_stride, rest, b);
    const int n_vectors = (n_rows - i) / N_LANES;
    if (n_vectors == 3) multiply_tile<3, IS_SET, N_LANES>(tile + i, c_stride, rest, b);
    if (n_vectors == 2) multiply_tile<2, IS_SET, N_LANES>(tile + i, c_stride, rest, b);
    if (n_vectors == 1) multiply_tile<1, IS_SET, N_LANES>(tile + i, c_stride, rest, b);
    if constexpr (N_LANES > GRAIN) {
      i += n_vectors * N_LANES, rest.a += n_vectors * N_LANES;
      if (i < n_rows) multiply_tile<1, IS_SET, GRAIN>(tile + i, c_stride, rest, b);
    }
  }
}

constexpr int DEPTH = 192, COLUMNS = 96;  // of a packed piece: three rows of B in the first cache, all in the second

// The columns [first_column, first_column + n_columns) of multiply() below, packed: each column of a large panel lies
// on a page of its own, and a tile walks over all of them.
template <bool IS_SET, bool IS_WIDE, class Real>
INLINE void multiply_packed(Real* c, int c_stride, const Real* a, const Real* b, int stride, int depth, int n_rows,
                            int first_column, int n_columns) {
  constexpr int N_ROWS = ROWS<IS_WIDE, Real>;
  alignas(64) Real a_piece[DEPTH * N_ROWS];
  alignas(64) Real b_piece[DEPTH * COLUMNS];
  for (int j = 0; j < n_columns; j += 3)
    for (int k = 0; k < depth; ++k)
      for (int r = 0; r < 3; ++r) b_piece[j * depth + 3 * k + r] = b[first_column + j + r + k * stride];
  for (int i = first_column / N_ROWS * N_ROWS; i < n_rows; i += N_ROWS) {
    const int n_here = std::min(n_rows - i, N_ROWS);
    const int n_lower = std::min(n_columns, i + n_here - first_column);
    for (int k = 0; k < depth; ++k)
      for (int r = 0; r < n_here; ++r) a_piece[k * N_ROWS + r] = a[i + r + k * stride];
    multiply_rows<IS_SET, IS_WIDE, Real>(c + i + first_column * c_stride, c_stride,
                                         {a_piece, b_piece, N_ROWS, 3, 3 * depth, depth}, n_here, n_lower);
  }
}

// C -= A B^T, or = with IS_SET, for n_rows (a multiple of GRAIN) x n_columns (of 3), lower triangle: column j from row
// j on
template <bool IS_SET, class Real>
INLINE void multiply_few(Real* c, int c_stride, const Real* a, const Real* b, int stride, int depth, int n_rows,
                         int n_columns) {
  constexpr int N_ROWS = ROWS<false, Real>;
  for (int i = 0; i < n_rows; i += N_ROWS) {
    const int n_here = std::min(n_rows - i, N_ROWS);
    multiply_rows<IS_SET, false, Real>(c + i, c_stride, {a + i, b, stride, stride, 3, depth}, n_here,
                                       std::min(n_columns, i + n_here));
  }
}

// the same where packing pays
template <bool IS_SET, bool IS_WIDE, class Real>
INLINE void multiply(Real* c, int c_stride, const Real* a, const Real* b, int stride, int depth, int n_rows,
                     int n_columns) {
  if (depth < 48 || n_rows < 64) return multiply_few<IS_SET>(c, c_stride, a, b, stride, depth, n_rows, n_columns);
  for (int k = 0; k < depth; k += DEPTH)
    for (int j = 0; j < n_columns; j += COLUMNS) {
      const Real *a_from = a + k * stride, *b_from = b + k * stride;
      const int depth_here = std::min(depth - k, DEPTH), n_here = std::min(n_columns - j, COLUMNS);
      if (IS_SET && k == 0)
        multiply_packed<true, IS_WIDE>(c, c_stride, a_from, b_from, stride, depth_here, n_rows, j, n_here);
      else
        multiply_packed<false, IS_WIDE>(c, c_stride, a_from, b_from, stride, depth_here, n_rows, j, n_here);
    }
}

// Cholesky of the lower triangle in place; inverse: 1 / diagonal
template <class Real>
INLINE bool factor_diagonal(Real* a, int stride, int n, const Real* least, Real* inverse) {
  for (int k = 0; k < n; ++k) {
    Real pivot = a[k + k * stride];
    for (int d = 0; d < k; ++d) pivot -= a[k + d * stride] * a[k + d * stride];
    if (!(pivot > least[k] && std::isfinite(pivot))) return false;
    a[k + k * stride] = std::sqrt(pivot);
    inverse[k] = 1 / a[k + k * stride];
    for (int i = k + 1; i < n; ++i) {
      Real sum = a[i + k * stride];
      for (int d = 0; d < k; ++d) sum -= a[i + d * stride] * a[k + d * stride];
      a[i + k * stride] = sum * inverse[k];
    }
  }
  return true;
}

// X L^T = B for N columns in place, the rows of one vector
template <int N_LANES, int N, class Real>
INLINE void solve_vector(Real* b, int stride, const Real* lower, const Real* inverse) {
  typename VectorOf<Real, N_LANES>::Rows x[N];
  for (int c = 0; c < N; ++c) load(x[c], b + c * stride);
  for (int c = 0; c < N; ++c) {
    x[c] *= inverse[c];
    for (int d = c + 1; d < N; ++d) x[d] -= x[c] * lower[d + c * stride];
  }
  for (int c = 0; c < N; ++c) store(b + c * stride, x[c]);
}

// the same for rows [0, n_rows), n_rows a multiple of GRAIN
template <int N, class Real>
INLINE void solve_rows(Real* b, int stride, int n_rows, const Real* lower, const Real* inverse) {
  constexpr int N_LANES = LANES<Real>;
  int i = 0;
  for (; i + N_LANES <= n_rows; i += N_LANES) solve_vector<N_LANES, N>(b + i, stride, lower, inverse);
  if (i < n_rows) solve_vector<GRAIN, N>(b + i, stride, lower, inverse);
}

// Left-looking over pieces of COLUMNS and, in each, over blocks of BLOCK columns: each is updated by all before it at
// once, so that the sums stay in registers.
template <bool IS_WIDE, class Real>
INLINE bool factor(const Panel<Real>& panel, const Real* least) {
  const int stride = panel.stride;
  for (int first = 0; first < panel.n_pivots; first += BLOCK) {
    const int n = std::min(BLOCK, panel.n_pivots - first), piece = first / COLUMNS * COLUMNS;
    Real* diagonal = panel.values + first + first * stride;
    if (first == piece && first > 0) {
      const Real* before = panel.values + first;
      multiply<false, IS_WIDE, Real>(diagonal, stride, before, before, stride, first, panel.last_row - first,
                                     std::min(COLUMNS, panel.n_pivots - first));
    } else if (first > piece) {
      const Real* before = panel.values + first + piece * stride;
      multiply_few<false, Real>(diagonal, stride, before, before, stride, first - piece, panel.last_row - first, n);
    }
    Real inverse[BLOCK];
    if (!factor_diagonal(diagonal, stride, n, least + first, inverse)) return false;
    const int below = first + n == panel.n_pivots ? panel.first_row : first + n, n_rows = panel.last_row - below;
    Real* rows = panel.values + below + first * stride;
    if (n == 12) solve_rows<12>(rows, stride, n_rows, diagonal, inverse);
    if (n == 9) solve_rows<9>(rows, stride, n_rows, diagonal, inverse);
    if (n == 6) solve_rows<6>(rows, stride, n_rows, diagonal, inverse);
    if (n == 3) solve_rows<3>(rows, stride, n_rows, diagonal, inverse);
  }
  return true;
}

template <bool IS_WIDE, class Real>
INLINE void multiply_rows_below(const Panel<Real>& panel, Real* update, int update_stride) {
  const Real* rows = panel.values + panel.first_row;
  multiply<true, IS_WIDE, Real>(update, update_stride, rows, rows, panel.stride, panel.n_pivots,
                                panel.last_row - panel.first_row, panel.n_rows);
}

// what no template can be: a function for each kind of processor
#define FOR_EACH_REAL(Real)                                                                     \
  FOR_WIDE_PROCESSOR bool factor_wide(const Panel<Real>& panel, const Real* least) {            \
    return factor<true>(panel, least);                                                          \
  }                                                                                             \
  FOR_EACH_PROCESSOR bool factor_narrow(const Panel<Real>& panel, const Real* least) {          \
    return factor<false>(panel, least);                                                         \
  }                                                                                             \
  FOR_WIDE_PROCESSOR void multiply_wide(const Panel<Real>& panel, Real* update, int stride) {   \
    multiply_rows_below<true>(panel, update, stride);                                           \
  }                                                                                             \
  FOR_EACH_PROCESSOR void multiply_narrow(const Panel<Real>& panel, Real* update, int stride) { \
    multiply_rows_below<false>(panel, update, stride);                                          \
  }
FOR_EACH_REAL(double)
FOR_EACH_REAL(float)

}  // namespace

template <class Real>
bool factor_panel(const Panel<Real>& panel, const Real* least) {
  return HAS_WIDE_PROCESSOR ? factor_wide(panel, least) : factor_narrow(panel, least);
}

template <class Real>
void set_negative_outer_product(const Panel<Real>& panel, Real* update, int update_stride) {
  HAS_WIDE_PROCESSOR ? multiply_wide(panel, update, update_stride) : multiply_narrow(panel, update, update_stride);
}

template bool factor_panel(const Panel<double>&, const double*);
template bool factor_panel(const Panel<float>&, const float*);
template void set_negative_outer_product(const Panel<double>&, double*, int);
template void set_negative_outer_product(const Panel<float>&, float*, int);

}  // namespace pvg
