// Vectors of rows, and functions for each kind of processor: for the files of front_kernels.hpp alone.
#pragma once

// one function for each kind of processor, chosen when the program starts
#if defined(__x86_64__) && defined(__gnu_linux__)
#include <immintrin.h>
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

// N_LANES rows in a vector, which begin at a multiple of four
template <class Real, int N_LANES>
struct VectorOf;
template <>
struct VectorOf<double, 4> {
  using Rows = double __attribute__((vector_size(32), may_alias));
};
template <>
struct VectorOf<double, 8> {
  using Rows = double __attribute__((vector_size(64), may_alias, aligned(32)));
};
template <>
struct VectorOf<float, 4> {
  using Rows = float __attribute__((vector_size(16), may_alias));
};
template <>
struct VectorOf<float, 8> {
  using Rows = float __attribute__((vector_size(32), may_alias, aligned(16)));
};
template <>
struct VectorOf<float, 16> {
  using Rows = float __attribute__((vector_size(64), may_alias, aligned(16)));
};
template <class Real>
constexpr int LANES = 32 / sizeof(Real);  // of AVX2
template <class Real>
constexpr int WIDE_LANES = 64 / sizeof(Real);  // of AVX-512
constexpr int GRAIN = 4;                       // rows come in multiples of it
constexpr int BLOCK = 12;                      // columns factored at once, four nodes

template <class AnyVector, class Real>
INLINE void load(AnyVector& v, const Real* from) {
  v = *reinterpret_cast<const AnyVector*>(from);
}
template <class AnyVector, class Real>
INLINE void store(Real* to, const AnyVector& v) {
  *reinterpret_cast<AnyVector*>(to) = v;
}

}  // namespace pvg
