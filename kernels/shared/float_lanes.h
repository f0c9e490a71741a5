// A float of each of N_FLOATS pixels or samples side by side, where a work-item does the same arithmetic for all of them:
// the host asks for 16 on a CPU, whose compiler finds vectors by itself only in loops without decisions. A device whose
// work-items are its lanes has one in each. A mask is 0 where not, else anything. Device only.
#ifndef PVG_SHARED_FLOAT_LANES_H
#define PVG_SHARED_FLOAT_LANES_H

#ifndef N_FLOATS
#define N_FLOATS 1
#endif

#if N_FLOATS == 16
typedef float16 floats;
typedef int16 ints;
#define ANY_FLOAT(mask) any(mask)
#define AS_FLOATS(v) convert_float16(v)
#define AS_INTS(v) convert_int16(v)
#define LOAD_FLOATS(i, from) vload16(i, from)
#define STORE_FLOATS(v, i, to) vstore16(v, i, to)
#define FLOAT_NUMBERS ((int16)(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15))  // of the lanes
#elif N_FLOATS == 1
typedef float floats;
typedef int ints;
#define ANY_FLOAT(mask) ((mask) != 0)
#define AS_FLOATS(v) convert_float(v)
#define AS_INTS(v) convert_int(v)
#define LOAD_FLOATS(i, from) ((from)[i])
#define STORE_FLOATS(v, i, to) ((to)[i] = (v))
#define FLOAT_NUMBERS 0
#endif
#define FLOAT_LANE(v, lane) (((float*)&(v))[lane])
#define INT_LANE(v, lane) (((int*)&(v))[lane])

static inline float least_float(const floats v) {
#if N_FLOATS == 16
  const float8 by8 = min(v.lo, v.hi);
  const float4 by4 = min(by8.lo, by8.hi);
  const float2 by2 = min(by4.lo, by4.hi);
  return min(by2.x, by2.y);
#else
  return v;
#endif
}

#endif
