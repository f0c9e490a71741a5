// Eight comparisons to eight bits. OpenCL C has no such word, so the portable way is an AND with the powers of two and
// a reduction by OR; on x86 with AVX under PoCL one instruction does it (13 to 19 % of a traversal), chosen by the host
// with -DPVG_X86_AVX.
#ifndef PVG_SHARED_MASK_CL
#define PVG_SHARED_MASK_CL

// bit k of the result: element k is true (-1)
inline uint mask8(const int8 is_true) {
#ifdef PVG_X86_AVX
  return (uint)__builtin_ia32_movmskps256(as_float8(is_true));
#else
  const int8 bits = is_true & (int8)(1, 2, 4, 8, 16, 32, 64, 128);
  const int4 a = bits.lo | bits.hi;
  const int2 b = a.lo | a.hi;
  return (uint)(b.x | b.y);
#endif
}

inline uint mask4(const int4 is_true) {
#ifdef PVG_X86_AVX
  return (uint)__builtin_ia32_movmskps(as_float4(is_true));
#else
  const int4 bits = is_true & (int4)(1, 2, 4, 8);
  const int2 a = bits.lo | bits.hi;
  return (uint)(a.x | a.y);
#endif
}

// index of the lowest set bit, m != 0
inline uint lowest_bit(const uint m) {
#ifdef PVG_X86_AVX
  return (uint)__builtin_ctz(m);
#else
  return 31u - clz(m & (0u - m));
#endif
}

#endif
