// Random numbers without state: a number depends on its key (seed, frame, camera, pixel), sample and dimension only.
//   hash:      PCG output permutation, Jarzynski and Olano 2020, "Hash Functions for GPU Rendering"
//   sample_2d: the first two dimensions of Sobol's sequence, shuffled and Owen-scrambled by hashing, so that the
//   samples
//              of one pixel and dimension stand one in each stratum: Burley 2020, "Practical Hash-based Owen
//              Scrambling"
#ifndef PVG_SHARED_RNG_CL
#define PVG_SHARED_RNG_CL

// One number, or as many as a vector has: PVG_RANDOM(T, ) and PVG_RANDOM(uint8, _8) are the same functions.
#define PVG_RANDOM(T, SUFFIX)                                                                                       \
  static inline T hash_u32##SUFFIX(const T x) {                                                                     \
    const T state = x * 747796405u + 2891336453u;                                                                   \
    const T word = ((state >> ((state >> 28) + 4u)) ^ state) * 277803737u;                                          \
    return (word >> 22) ^ word;                                                                                     \
  }                                                                                                                 \
  static inline T reverse_bits##SUFFIX(T x) {                                                                       \
    x = (x >> 16) | (x << 16);                                                                                      \
    x = ((x & 0x00ff00ffu) << 8) | ((x & 0xff00ff00u) >> 8);                                                        \
    x = ((x & 0x0f0f0f0fu) << 4) | ((x & 0xf0f0f0f0u) >> 4);                                                        \
    x = ((x & 0x33333333u) << 2) | ((x & 0xccccccccu) >> 2);                                                        \
    return ((x & 0x55555555u) << 1) | ((x & 0xaaaaaaaau) >> 1);                                                     \
  }                                                                                                                 \
  /* a bijection in which every bit depends on the lower bits alone (Laine and Karras 2011, constants: Burley 2020) */ \
  static inline T laine_karras##SUFFIX(T x, const T seed) {                                                         \
    x += seed;                                                                                                      \
    x ^= x * 0x6c50b47cu;                                                                                           \
    x ^= x * 0xb82f1e52u;                                                                                           \
    x ^= x * 0xc7afe638u;                                                                                           \
    return x ^ (x * 0x8d22f6e6u);                                                                                   \
  }                                                                                                                 \
  /* second dimension of Sobol's sequence with its bits reversed: the generator matrix is Pascal's triangle modulo */ \
  /* 2, a product of five sparse factors */                                                                         \
  static inline T sobol_second_reversed##SUFFIX(T x) {                                                              \
    x ^= (x >> 1) & 0x55555555u;                                                                                    \
    x ^= (x >> 2) & 0x33333333u;                                                                                    \
    x ^= (x >> 4) & 0x0f0f0f0fu;                                                                                    \
    x ^= (x >> 8) & 0x00ff00ffu;                                                                                    \
    return x ^ ((x >> 16) & 0x0000ffffu);                                                                           \
  }
PVG_RANDOM(uint, )
PVG_RANDOM(uint4, _4)
PVG_RANDOM(uint8, _8)
PVG_RANDOM(uint16, _16)

static inline uint hash_combine(const uint h, const uint x) { return hash_u32(h ^ hash_u32(x)); }

// in [0, 1): 24 bits, so that it never rounds to 1
static inline float unit_float(const uint x) { return (float)(x >> 8) * 0x1p-24f; }

#define SCRAMBLE_X 0x9e3779b9u
#define SCRAMBLE_Y 0x3c6ef372u

// point number `sample` of the set that belongs to (key, dimension), in [0, 1)^2
static inline float2 sample_2d(const uint key, const uint sample, const uint dimension) {
  const uint seed = hash_combine(key, dimension);
  const uint index = reverse_bits(laine_karras(reverse_bits(sample), seed));
  const uint x = reverse_bits(laine_karras(index, hash_u32(seed ^ SCRAMBLE_X)));
  const uint y = reverse_bits(laine_karras(sobol_second_reversed(index), hash_u32(seed ^ SCRAMBLE_Y)));
  return (float2)(unit_float(x), unit_float(y));
}

// The same points of dimension, dimension + 1, + 2 and + 3 at once, which takes vector units little more than one of
// them: first their four x, then their four y.
static inline float8 sample_2d_4(const uint key, const uint sample, const uint dimension) {
  const uint4 seed = hash_u32_4(key ^ hash_u32_4(dimension + (uint4)(0, 1, 2, 3)));
  const uint4 index = reverse_bits_4(laine_karras_4((uint4)(reverse_bits(sample)), seed));
  const uint8 points = (uint8)(index, sobol_second_reversed_4(index));
  const uint8 bits = reverse_bits_8(laine_karras_8(points, hash_u32_8((uint8)(seed ^ SCRAMBLE_X, seed ^ SCRAMBLE_Y))));
  return convert_float8(as_int8(bits >> 8)) * 0x1p-24f;
}

// The same points of sixteen keys and samples: vector units hold all of them, and their chains of multiplications overlap.
static inline void sample_2d_16(const uint16 key, const uint16 sample, const uint dimension, float16* x, float16* y) {
  const uint16 seed = hash_u32_16(key ^ hash_u32(dimension));
  const uint16 index = reverse_bits_16(laine_karras_16(reverse_bits_16(sample), seed));
  const uint16 x_bits = reverse_bits_16(laine_karras_16(index, hash_u32_16(seed ^ SCRAMBLE_X)));
  const uint16 y_bits =
      reverse_bits_16(laine_karras_16(sobol_second_reversed_16(index), hash_u32_16(seed ^ SCRAMBLE_Y)));
  *x = convert_float16(as_int16(x_bits >> 8)) * 0x1p-24f;
  *y = convert_float16(as_int16(y_bits >> 8)) * 0x1p-24f;
}

#endif
