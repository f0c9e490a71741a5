#include "pipeline/bench/cholmod_factor.hpp"

#include <stdexcept>

#ifdef PVG_CHOLMOD
#include <cholmod.h>

#include <vector>

namespace pvg {

struct CholmodFactor::Impl {
  Impl() { cholmod_start(&common); }
  ~Impl() {
    cholmod_free_factor(&factor, &common);
    cholmod_free_sparse(&matrix, &common);
    cholmod_finish(&common);
  }
  cholmod_common common;
  cholmod_sparse* matrix = nullptr;
  cholmod_factor* factor = nullptr;
  std::vector<std::size_t> source;  // [n_nonzeros] number in the blocks
  std::vector<int> unknown;         // [n_nodes] its first; -1: fixed
  int n = 0;
};

CholmodFactor::CholmodFactor(const MatrixPattern& pattern) : impl_(std::make_unique<Impl>()) {
  Impl& m = *impl_;
  for (u32 node = 0; node < pattern.n_nodes(); ++node) {
    const bool is_fixed = pattern.first[node] == pattern.first[node + 1];
    m.unknown.push_back(is_fixed ? -1 : m.n);
    if (!is_fixed) m.n += 3;
  }
  // column by column, the lower triangle: the matrix is symmetric, so its rows serve as columns
  std::vector<int> first = {0}, row;
  for (u32 node = 0; node < pattern.n_nodes(); ++node)
    for (int c = 0; c < 3 && m.unknown[node] >= 0; ++c) {
      for (u32 k = pattern.first[node]; k < pattern.first[node + 1]; ++k)
        for (int r = 0; r < 3; ++r) {
          const int i = m.unknown[pattern.column[k]] + r;
          if (i < m.unknown[node] + c) continue;
          row.push_back(i);
          m.source.push_back(9 * std::size_t(k) + 3 * std::size_t(c) + std::size_t(r));
        }
      first.push_back(int(row.size()));
    }
  m.matrix =
      cholmod_allocate_sparse(std::size_t(m.n), std::size_t(m.n), row.size(), true, true, -1, CHOLMOD_REAL, &m.common);
  std::copy(first.begin(), first.end(), static_cast<int*>(m.matrix->p));
  std::copy(row.begin(), row.end(), static_cast<int*>(m.matrix->i));
  m.factor = cholmod_analyze(m.matrix, &m.common);
}

CholmodFactor::~CholmodFactor() = default;

bool CholmodFactor::factorize(std::span<const double> blocks) {
  Impl& m = *impl_;
  double* values = static_cast<double*>(m.matrix->x);
  for (std::size_t k = 0; k < m.source.size(); ++k) values[k] = blocks[m.source[k]];
  return cholmod_factorize(m.matrix, m.factor, &m.common) && m.common.status == CHOLMOD_OK;
}

void CholmodFactor::solve(std::span<double> x) {
  Impl& m = *impl_;
  cholmod_dense* b = cholmod_allocate_dense(std::size_t(m.n), 1, std::size_t(m.n), CHOLMOD_REAL, &m.common);
  double* values = static_cast<double*>(b->x);
  for (std::size_t node = 0; node < m.unknown.size(); ++node)
    for (int c = 0; c < 3 && m.unknown[node] >= 0; ++c) values[m.unknown[node] + c] = x[3 * node + std::size_t(c)];
  cholmod_dense* solved = cholmod_solve(CHOLMOD_A, m.factor, b, &m.common);
  const double* result = static_cast<const double*>(solved->x);
  for (std::size_t node = 0; node < m.unknown.size(); ++node)
    for (int c = 0; c < 3; ++c) x[3 * node + std::size_t(c)] = m.unknown[node] < 0 ? 0 : result[m.unknown[node] + c];
  cholmod_free_dense(&solved, &m.common);
  cholmod_free_dense(&b, &m.common);
}

std::size_t CholmodFactor::n_numbers() const {
  return impl_->factor->is_super ? impl_->factor->xsize : impl_->factor->nzmax;
}

bool CholmodFactor::is_there() { return true; }

}  // namespace pvg

#else

namespace pvg {

struct CholmodFactor::Impl {};
CholmodFactor::CholmodFactor(const MatrixPattern&) { throw std::logic_error("the program was built without CHOLMOD"); }
CholmodFactor::~CholmodFactor() = default;
bool CholmodFactor::factorize(std::span<const double>) { return false; }
void CholmodFactor::solve(std::span<double>) {}
std::size_t CholmodFactor::n_numbers() const { return 0; }
bool CholmodFactor::is_there() { return false; }

}  // namespace pvg
#endif
