// Sixteen paths side by side, on a CPU: each of their numbers in a vector of its own, gathered from the rows of four
// floats that lie in memory and scattered to them; and the arithmetic of such vectors.
#ifndef PVG_RENDER_LANES_ROWS_CL
#define PVG_RENDER_LANES_ROWS_CL
#include "render/lanes/packet.cl"

// the first to fourth number of sixteen rows
typedef struct {
  float16 x, y, z, w;
} Rows;

#ifdef POCL_SHUFFLED
#define SHUFFLED_16 POCL_SHUFFLED
#else
#define SHUFFLED_16(a, b, i0, i1, i2, i3, i4, i5, i6, i7, i8, i9, i10, i11, i12, i13, i14, i15) \
  shuffle2(a, b, (uint16)(i0, i1, i2, i3, i4, i5, i6, i7, i8, i9, i10, i11, i12, i13, i14, i15))
#endif

// In every four elements: the first or the second halves of a and b interleaved; the first or the second pair of a, then
// that of b.
#define FIRST_HALVES(a, b) SHUFFLED_16(a, b, 0, 16, 1, 17, 4, 20, 5, 21, 8, 24, 9, 25, 12, 28, 13, 29)
#define SECOND_HALVES(a, b) SHUFFLED_16(a, b, 2, 18, 3, 19, 6, 22, 7, 23, 10, 26, 11, 27, 14, 30, 15, 31)
#define FIRST_PAIRS(a, b) SHUFFLED_16(a, b, 0, 1, 16, 17, 4, 5, 20, 21, 8, 9, 24, 25, 12, 13, 28, 29)
#define SECOND_PAIRS(a, b) SHUFFLED_16(a, b, 2, 3, 18, 19, 6, 7, 22, 23, 10, 11, 26, 27, 14, 15, 30, 31)

// four matrices of 4 x 4: quarter q of x, y, z and w are the rows of matrix q before, and its columns after
ALWAYS_INLINE Rows transposed(const Rows r) {
  const float16 xy_first = FIRST_HALVES(r.x, r.y), xy_second = SECOND_HALVES(r.x, r.y);
  const float16 zw_first = FIRST_HALVES(r.z, r.w), zw_second = SECOND_HALVES(r.z, r.w);
  const Rows t = {FIRST_PAIRS(xy_first, zw_first), SECOND_PAIRS(xy_first, zw_first), FIRST_PAIRS(xy_second, zw_second),
                  SECOND_PAIRS(xy_second, zw_second)};
  return t;
}

// the rows at[k] * stride + offset, k = 0 .. 15
ALWAYS_INLINE Rows load_rows(global const float4* from, const uint* at, const uint stride, const uint offset) {
#define ROW(k) from[at[k] * stride + offset]
  const Rows r = {(float16)(ROW(0), ROW(4), ROW(8), ROW(12)), (float16)(ROW(1), ROW(5), ROW(9), ROW(13)),
                  (float16)(ROW(2), ROW(6), ROW(10), ROW(14)), (float16)(ROW(3), ROW(7), ROW(11), ROW(15))};
#undef ROW
  return transposed(r);
}

// the same; is_one: all at[k] are the same
ALWAYS_INLINE Rows load_rows_or_one(global const float4* from, const uint* at, const bool is_one, const uint stride,
                                    const uint offset) {
  if (!is_one) return load_rows(from, at, stride, offset);
  const float4 row = from[at[0] * stride + offset];
  const Rows r = {(float16)(row.x), (float16)(row.y), (float16)(row.z), (float16)(row.w)};
  return r;
}

// PLACE(k) = row k of the transposed r
#define FOUR_ROWS(r, PLACE, k, part) \
  PLACE(k) = r.x.part;               \
  PLACE((k) + 1) = r.y.part;         \
  PLACE((k) + 2) = r.z.part;         \
  PLACE((k) + 3) = r.w.part;
#define SIXTEEN_ROWS(r, PLACE)   \
  FOUR_ROWS(r, PLACE, 0, s0123)  \
  FOUR_ROWS(r, PLACE, 4, s4567)  \
  FOUR_ROWS(r, PLACE, 8, s89ab)  \
  FOUR_ROWS(r, PLACE, 12, scdef)

// row k to at[k]
ALWAYS_INLINE void store_rows(const Rows rows, global float4* to, const uint* at) {
  const Rows r = transposed(rows);
#define PLACE(k) to[at[k]]
  SIXTEEN_ROWS(r, PLACE)
#undef PLACE
}

// only those whose bit is set
ALWAYS_INLINE void store_rows_where(const uint which, const Rows rows, global float4* to, const uint* at) {
  if (which == 0xffffu) return store_rows(rows, to, at);
  const Rows r = transposed(rows);
  float4 row[PACKET];
#define PLACE(k) row[k]
  SIXTEEN_ROWS(r, PLACE)
#undef PLACE
  for (uint rest = which; rest; rest &= rest - 1) to[at[lowest_bit(rest)]] = row[lowest_bit(rest)];
}

ALWAYS_INLINE Packet vectors_of(const Rows r) {
  const Packet p = {r.x, r.y, r.z};
  return p;
}
ALWAYS_INLINE Rows rows_of(const Packet p, const float16 w) {
  const Rows r = {p.x, p.y, p.z, w};
  return r;
}

ALWAYS_INLINE float16 least(const float16 a, const float16 b) { return a < b ? a : b; }
ALWAYS_INLINE float16 largest(const float16 a, const float16 b) { return a > b ? a : b; }
ALWAYS_INLINE float16 sixteen(const float x) { return (float16)(x); }
ALWAYS_INLINE float16 clamped(const float16 x) { return least(largest(x, sixteen(0.0f)), sixteen(1.0f)); }  // to [0, 1]

ALWAYS_INLINE Packet packet_of(const float3 v) {
  const Packet p = {sixteen(v.x), sixteen(v.y), sixteen(v.z)};
  return p;
}
ALWAYS_INLINE float16 dots(const Packet a, const Packet b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
ALWAYS_INLINE Packet crosses(const Packet a, const Packet b) {
  const Packet p = {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
  return p;
}
ALWAYS_INLINE Packet plus(const Packet a, const Packet b) {
  const Packet p = {a.x + b.x, a.y + b.y, a.z + b.z};
  return p;
}
ALWAYS_INLINE Packet minus(const Packet a, const Packet b) {
  const Packet p = {a.x - b.x, a.y - b.y, a.z - b.z};
  return p;
}
ALWAYS_INLINE Packet negated(const Packet a) {
  const Packet p = {-a.x, -a.y, -a.z};
  return p;
}
ALWAYS_INLINE Packet times(const Packet a, const float16 s) {
  const Packet p = {a.x * s, a.y * s, a.z * s};
  return p;
}
ALWAYS_INLINE Packet products(const Packet a, const Packet b) {
  const Packet p = {a.x * b.x, a.y * b.y, a.z * b.z};
  return p;
}
ALWAYS_INLINE Packet chosen(const int16 is_first, const Packet a, const Packet b) {
  const Packet p = {is_first ? a.x : b.x, is_first ? a.y : b.y, is_first ? a.z : b.z};
  return p;
}
ALWAYS_INLINE Packet units(const Packet a) { return times(a, rsqrt(largest(dots(a, a), sixteen(1e-37f)))); }  // unit()
#endif
