// 3 x 3 matrices as three columns. Device only.
#ifndef PVG_SHARED_MAT3_CL
#define PVG_SHARED_MAT3_CL
#include "shared/real.h"

typedef struct {
  real3 column[3];
} Mat3;

static inline Mat3 mat3_of_columns(const real3 a, const real3 b, const real3 c) {
  Mat3 m;
  m.column[0] = a;
  m.column[1] = b;
  m.column[2] = c;
  return m;
}

static inline Mat3 mat3_identity(void) { return mat3_of_columns((real3)(1, 0, 0), (real3)(0, 1, 0), (real3)(0, 0, 1)); }

// a b^T
static inline Mat3 mat3_outer(const real3 a, const real3 b) { return mat3_of_columns(a * b.x, a * b.y, a * b.z); }

static inline Mat3 mat3_plus(const Mat3 a, const Mat3 b) {
  return mat3_of_columns(a.column[0] + b.column[0], a.column[1] + b.column[1], a.column[2] + b.column[2]);
}

static inline Mat3 mat3_scaled(const Mat3 m, const real s) {
  return mat3_of_columns(m.column[0] * s, m.column[1] * s, m.column[2] * s);
}

static inline Mat3 mat3_transposed(const Mat3 m) {
  return mat3_of_columns((real3)(m.column[0].x, m.column[1].x, m.column[2].x),
                         (real3)(m.column[0].y, m.column[1].y, m.column[2].y),
                         (real3)(m.column[0].z, m.column[1].z, m.column[2].z));
}

// M v
static inline real3 mat3_times(const Mat3 m, const real3 v) {
  return m.column[0] * v.x + m.column[1] * v.y + m.column[2] * v.z;
}

// M^T v
static inline real3 mat3_transposed_times(const Mat3 m, const real3 v) {
  return (real3)(dot(m.column[0], v), dot(m.column[1], v), dot(m.column[2], v));
}

static inline real mat3_determinant(const Mat3 m) { return dot(m.column[0], cross(m.column[1], m.column[2])); }

// d det(M) / dM = det(M) M^-T, also where M is singular
static inline Mat3 mat3_cofactor(const Mat3 m) {
  return mat3_of_columns(cross(m.column[1], m.column[2]), cross(m.column[2], m.column[0]),
                         cross(m.column[0], m.column[1]));
}

// sum of squares of all entries
static inline real mat3_square_norm(const Mat3 m) {
  return dot(m.column[0], m.column[0]) + dot(m.column[1], m.column[1]) + dot(m.column[2], m.column[2]);
}

#endif
