// Eight comparisons to eight bits. OpenCL C has no such word, so the portable way is an AND with the powers of two and
// a reduction by OR; where PoCL compiles for x86, one instruction (shared/pocl.h).
#ifndef PVG_SHARED_MASK_CL
#define PVG_SHARED_MASK_CL
#include "shared/pocl.h"

// bit k of the result: element k is true (-1)
static inline uint mask8(const int8 is_true) {
#ifdef POCL_MASK8
  return (uint)POCL_MASK8(is_true);
#else
  const int8 bits = is_true & (int8)(1, 2, 4, 8, 16, 32, 64, 128);
  const int4 a = bits.lo | bits.hi;
  const int2 b = a.lo | a.hi;
  return (uint)(b.x | b.y);
#endif
}

static inline uint mask16(const int16 is_true) {
#ifdef POCL_MASK16
  return (uint)POCL_MASK16(is_true);
#else
  return mask8(is_true.lo) | mask8(is_true.hi) << 8;
#endif
}

// the way back: element k is -1 where bit k is set, else 0
static inline int16 lanes_of(const uint bits) {
  return ((int16)((int)bits) & (int16)(1, 2, 4, 8, 16, 32, 64, 128, 256, 512, 1024, 2048, 4096, 8192, 16384, 32768)) != 0;
}

static inline uint mask4(const int4 is_true) {
#ifdef POCL_MASK4
  return (uint)POCL_MASK4(is_true);
#else
  const int4 bits = is_true & (int4)(1, 2, 4, 8);
  const int2 a = bits.lo | bits.hi;
  return (uint)(a.x | a.y);
#endif
}

// elements of v by the last three bits of the numbers
static inline int8 elements_of(const int8 v, const int8 number) {
#ifdef POCL_ELEMENTS8
  return POCL_ELEMENTS8(v, number);
#else
  return shuffle(v, as_uint8(number));
#endif
}

// index of the lowest set bit, m != 0
static inline uint lowest_bit(const uint m) {
#ifdef POCL_LOWEST_BIT
  return (uint)POCL_LOWEST_BIT(m);
#else
  return 31u - clz(m & (0u - m));
#endif
}

#endif
