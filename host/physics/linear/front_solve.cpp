// Solves with the factor of a front, sums of runs, and subnormal numbers (front_kernels.hpp).
#include <algorithm>

#include "host/physics/linear/front_kernels.hpp"
#include "host/physics/linear/front_vectors.hpp"

namespace pvg {
namespace {

// x[rows] -= L[rows x N] y, the rows of one vector
template <int N_LANES, int N, class Real>
INLINE void subtract_columns_of_vector(Real* x, const Real* lower, int stride, const Real* y) {
  typename VectorOf<Real, N_LANES>::Rows sum, rows;
  load(sum, x);
  for (int c = 0; c < N; ++c) {
    load(rows, lower + c * stride);
    sum -= rows * y[c];
  }
  store(x, sum);
}

template <int N, class Real>
INLINE void subtract_columns(Real* x, const Real* lower, int stride, int n_rows, const Real* y) {
  constexpr int N_LANES = LANES<Real>;
  int i = 0;
  for (; i + N_LANES <= n_rows; i += N_LANES) subtract_columns_of_vector<N_LANES, N>(x + i, lower + i, stride, y);
  if (i < n_rows) subtract_columns_of_vector<GRAIN, N>(x + i, lower + i, stride, y);
}

template <class Real, class AnyVector>
INLINE Real sum_of_lanes(const AnyVector& v) {
  if constexpr (sizeof(AnyVector) == 8 * sizeof(Real))
    return ((v[0] + v[1]) + (v[2] + v[3])) + ((v[4] + v[5]) + (v[6] + v[7]));
  else
    return (v[0] + v[1]) + (v[2] + v[3]);
}

// sum[N] += L[rows x N]^T x, the rows of one vector
template <int N, class Real, class AnyVector>
INLINE void add_products(AnyVector* sum, const Real* lower, int stride, const Real* x) {
  AnyVector here, rows;
  load(here, x);
  for (int c = 0; c < N; ++c) {
    load(rows, lower + c * stride);
    sum[c] += rows * here;
  }
}

// y[N] -= L[rows x N]^T x
template <int N, class Real>
INLINE void subtract_dot_products(Real* y, const Real* lower, int stride, int n_rows, const Real* x) {
  constexpr int N_LANES = LANES<Real>;
  typename VectorOf<Real, N_LANES>::Rows sum[N] = {};
  int i = 0;
  for (; i + N_LANES <= n_rows; i += N_LANES) add_products<N>(sum, lower + i, stride, x + i);
  for (int c = 0; c < N; ++c) y[c] -= sum_of_lanes<Real>(sum[c]);
  if constexpr (N_LANES > GRAIN) {
    if (i == n_rows) return;
    typename VectorOf<Real, GRAIN>::Rows last[N] = {};
    add_products<N>(last, lower + i, stride, x + i);
    for (int c = 0; c < N; ++c) y[c] -= sum_of_lanes<Real>(last[c]);
  }
}

template <class Real>
INLINE void forward(const Panel<Real>& panel, Real* x) {
  const int stride = panel.stride;
  for (int first = 0; first < panel.n_pivots; first += BLOCK) {
    const int n = std::min(BLOCK, panel.n_pivots - first);
    const Real* diagonal = panel.values + first + first * stride;
    Real* y = x + first;
    for (int c = 0; c < n; ++c) {
      y[c] /= diagonal[c + c * stride];
      for (int i = c + 1; i < n; ++i) y[i] -= diagonal[i + c * stride] * y[c];
    }
    const int below = first + n == panel.n_pivots ? panel.first_row : first + n, n_rows = panel.last_row - below;
    const Real* rows = panel.values + below + first * stride;
    if (n == 12) subtract_columns<12>(x + below, rows, stride, n_rows, y);
    if (n == 9) subtract_columns<9>(x + below, rows, stride, n_rows, y);
    if (n == 6) subtract_columns<6>(x + below, rows, stride, n_rows, y);
    if (n == 3) subtract_columns<3>(x + below, rows, stride, n_rows, y);
  }
}

template <class Real>
INLINE void backward(const Panel<Real>& panel, Real* x) {
  const int stride = panel.stride;
  for (int first = (panel.n_pivots - 1) / BLOCK * BLOCK; first >= 0; first -= BLOCK) {
    const int n = std::min(BLOCK, panel.n_pivots - first);
    const Real* diagonal = panel.values + first + first * stride;
    Real* y = x + first;
    const int below = first + n == panel.n_pivots ? panel.first_row : first + n, n_rows = panel.last_row - below;
    const Real* rows = panel.values + below + first * stride;
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

template <class Real>
INLINE void add(Real* to, const Real* from, const Run* runs, std::size_t n_runs) {
  for (std::size_t k = 0; k < n_runs; ++k) {
    const Run run = runs[k];
    for (int i = 0; i < run.n; ++i) to[run.to + i] += from[run.from + i];
  }
}

// what no template can be: a function for each kind of processor
#define FOR_EACH_REAL(Real)                                                                           \
  FOR_EACH_PROCESSOR void forward_here(const Panel<Real>& panel, Real* x) { forward(panel, x); }      \
  FOR_EACH_PROCESSOR void backward_here(const Panel<Real>& panel, Real* x) { backward(panel, x); }    \
  FOR_EACH_PROCESSOR void add_here(Real* to, const Real* from, const Run* runs, std::size_t n_runs) { \
    add(to, from, runs, n_runs);                                                                      \
  }
FOR_EACH_REAL(double)
FOR_EACH_REAL(float)

}  // namespace

#if defined(__x86_64__) && defined(__gnu_linux__)
SubnormalsAreZero::SubnormalsAreZero() : before_(_mm_getcsr()) {
  _mm_setcsr(before_ | _MM_FLUSH_ZERO_ON | _MM_DENORMALS_ZERO_ON);
}
SubnormalsAreZero::~SubnormalsAreZero() { _mm_setcsr(before_); }
#else
SubnormalsAreZero::SubnormalsAreZero() = default;
SubnormalsAreZero::~SubnormalsAreZero() = default;
#endif

template <class Real>
void solve_forward(const Panel<Real>& panel, Real* x) {
  forward_here(panel, x);
}

template <class Real>
void solve_backward(const Panel<Real>& panel, Real* x) {
  backward_here(panel, x);
}

template <class Real>
void add_runs(Real* to, const Real* from, const Run* runs, std::size_t n_runs) {
  add_here(to, from, runs, n_runs);
}

template void solve_forward(const Panel<double>&, double*);
template void solve_forward(const Panel<float>&, float*);
template void solve_backward(const Panel<double>&, double*);
template void solve_backward(const Panel<float>&, float*);
template void add_runs(double*, const double*, const Run*, std::size_t);
template void add_runs(float*, const float*, const Run*, std::size_t);

}  // namespace pvg
