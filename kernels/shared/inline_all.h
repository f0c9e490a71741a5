// To be included first by a kernel file of many small functions that take structs by value: PoCL's compiler calls
// larger functions and copies their structs, which cost a path tracer 12 % on a CPU. -DPVG_X86_AVX is PoCL on x86.
#ifdef PVG_X86_AVX
#undef inline  // PoCL has a meaning of its own for it
#define inline static inline __attribute__((always_inline))
#endif
