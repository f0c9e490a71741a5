// All that the kernels do for PoCL alone. -DPVG_X86_AVX, from avx_options() of host/device, says that PoCL compiles for an
// x86 CPU with AVX. Without it this file defines what every compiler understands.
#ifndef PVG_SHARED_POCL_H
#define PVG_SHARED_POCL_H

#ifdef PVG_X86_AVX

// A file of many small functions that take structs by value says PVG_INLINE_ALL before anything else: PoCL calls the
// larger ones and copies their structs, which cost a path tracer 12 %. PoCL itself defines `inline` as nothing.
#ifdef PVG_INLINE_ALL
#undef inline
#define inline inline __attribute__((always_inline))
#endif

// PoCL keeps the arrays of a kernel behind pointers; in a function of its own they lie at fixed places of the frame.
#define OUT_OF_LINE static __attribute__((noinline))

// One instruction each, where OpenCL C takes a reduction by OR (13 to 19 % of a traversal).
#define POCL_MASK8(is_true) __builtin_ia32_movmskps256(as_float8(is_true))
#define POCL_MASK4(is_true) __builtin_ia32_movmskps(as_float4(is_true))
#define POCL_LOWEST_BIT(m) __builtin_ctz(m)
#ifdef __AVX2__
#define POCL_ELEMENTS8(v, number) __builtin_ia32_permvarsi256(v, number)
#endif
#ifdef __AVX512DQ__
#define POCL_MASK16(is_true) __builtin_ia32_cvtd2mask512(is_true)
#endif

// Elements of two float16, those of the second from 16: PoCL's compiler takes a vector that is written by its elements
// apart, and needs an instruction for each.
#define POCL_SHUFFLED(a, b, i0, i1, i2, i3, i4, i5, i6, i7, i8, i9, i10, i11, i12, i13, i14, i15) \
  __builtin_shufflevector(a, b, i0, i1, i2, i3, i4, i5, i6, i7, i8, i9, i10, i11, i12, i13, i14, i15)

#else
#define OUT_OF_LINE static inline
#endif

// -DPVG_SIMULATED, from scripts/test_oclgrind.sh: Oclgrind does not run what inlining leaves behind (notes on aliases).
#ifdef PVG_SIMULATED
#define ALWAYS_INLINE static inline
#else
#define ALWAYS_INLINE static inline __attribute__((always_inline))
#endif

#endif
