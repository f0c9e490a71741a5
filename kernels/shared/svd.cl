// Singular values of a 3 x 3 matrix, F = U diag(sigma) V^T, U and V rotations (determinant +1), so that the smallest
// singular value carries the sign of det(F): sigma.x >= sigma.y >= |sigma.z|. One-sided Jacobi rotations of the columns
// (Hestenes 1958), which keep small singular values accurate. Also: the nearest positive semi-definite matrix.
#ifndef PVG_SHARED_SVD_CL
#define PVG_SHARED_SVD_CL
#include "shared/mat3.cl"

typedef struct {
  Mat3 u, v;
  real3 sigma;
} Svd3;

// Turns columns p and q of B (and of V with it) until they are orthogonal; false where they already were.
static inline bool svd3_orthogonalize(Mat3* b, Mat3* v, const int p, const int q) {
  const real3 bp = b->column[p], bq = b->column[q];
  const real pp = dot(bp, bp), qq = dot(bq, bq), pq = dot(bp, bq);
  // also leaves alone columns that are zero
  if (!(fabs(pq) > 1e-15 * sqrt(pp * qq))) return false;
  const real zeta = (qq - pp) / (2 * pq);
  const real t = copysign((real)1, zeta) / (fabs(zeta) + sqrt(1 + zeta * zeta));
  const real c = rsqrt(1 + t * t), s = c * t;
  b->column[p] = c * bp - s * bq;
  b->column[q] = s * bp + c * bq;
  const real3 vp = v->column[p], vq = v->column[q];
  v->column[p] = c * vp - s * vq;
  v->column[q] = s * vp + c * vq;
  return true;
}

// Puts the longer column first by a quarter turn, which keeps det(V) = +1.
static inline void svd3_order(Mat3* b, Mat3* v, const int p, const int q) {
  if (dot(b->column[p], b->column[p]) >= dot(b->column[q], b->column[q])) return;
  const real3 bp = b->column[p], vp = v->column[p];
  b->column[p] = b->column[q];
  b->column[q] = -bp;
  v->column[p] = v->column[q];
  v->column[q] = -vp;
}

// Some unit vector at right angles to the unit vector a.
static inline real3 perpendicular(const real3 a) {
  const real3 other = fabs(a.x) < 0.6 ? (real3)(1, 0, 0) : (real3)(0, 1, 0);
  return normalize(cross(a, other));
}

static inline Svd3 svd3(const Mat3 f) {
  Mat3 b = f, v = mat3_identity();
  // converges quadratically: 4 to 6 sweeps; the bound is never met by finite numbers
  for (int sweep = 0; sweep < 16; ++sweep) {
    const bool turned_01 = svd3_orthogonalize(&b, &v, 0, 1);
    const bool turned_02 = svd3_orthogonalize(&b, &v, 0, 2);
    const bool turned_12 = svd3_orthogonalize(&b, &v, 1, 2);
    if (!turned_01 && !turned_02 && !turned_12) break;
  }
  svd3_order(&b, &v, 0, 1);
  svd3_order(&b, &v, 1, 2);
  svd3_order(&b, &v, 0, 1);

  Svd3 r;
  r.v = v;
  const real first = length(b.column[0]);
  // directions that belong to a zero singular value are free: any that complete the frame
  const real3 u0 = first > 0 ? b.column[0] / first : (real3)(1, 0, 0);
  const real3 rest = b.column[1] - u0 * dot(u0, b.column[1]);
  const real second = length(rest);
  const real3 u1 = second > 1e-14 * first ? rest / second : perpendicular(u0);
  const real3 u2 = cross(u0, u1);
  r.u = mat3_of_columns(u0, u1, u2);
  r.sigma = (real3)(first, dot(u1, b.column[1]), dot(u2, b.column[2]));
  return r;
}

// One Jacobi rotation of the symmetric matrix A in the plane (p, q), r the third index: A <- R^T A R, V <- V R.
static inline void symmetric3_rotate(real a[3][3], Mat3* v, const int p, const int q, const int r) {
  if (a[p][q] == 0) return;
  const real theta = (a[q][q] - a[p][p]) / (2 * a[p][q]);
  const real t = copysign((real)1, theta) / (fabs(theta) + sqrt(1 + theta * theta));
  const real c = rsqrt(1 + t * t), s = c * t;
  a[p][p] -= t * a[p][q];
  a[q][q] += t * a[p][q];
  a[p][q] = a[q][p] = 0;
  const real rp = a[r][p], rq = a[r][q];
  a[r][p] = a[p][r] = c * rp - s * rq;
  a[r][q] = a[q][r] = s * rp + c * rq;
  const real3 vp = v->column[p], vq = v->column[q];
  v->column[p] = c * vp - s * vq;
  v->column[q] = s * vp + c * vq;
}

// The nearest positive semi-definite matrix to the symmetric M: negative eigenvalues become zero.
static inline Mat3 mat3_nearest_positive(const Mat3 m) {
  const real minor1 = m.column[0].x;
  const real minor2 = m.column[0].x * m.column[1].y - m.column[1].x * m.column[1].x;
  // positive leading minors: positive definite already (Sylvester), which is the rule
  if (minor1 > 0 && minor2 > 0 && mat3_determinant(m) > 0) return m;
  real a[3][3] = {{m.column[0].x, m.column[1].x, m.column[2].x},
                  {m.column[1].x, m.column[1].y, m.column[2].y},
                  {m.column[2].x, m.column[2].y, m.column[2].z}};
  Mat3 v = mat3_identity();
  for (int sweep = 0; sweep < 8; ++sweep) {
    symmetric3_rotate(a, &v, 0, 1, 2);
    symmetric3_rotate(a, &v, 0, 2, 1);
    symmetric3_rotate(a, &v, 1, 2, 0);
  }
  Mat3 sum = mat3_scaled(mat3_outer(v.column[0], v.column[0]), fmax(a[0][0], (real)0));
  sum = mat3_plus(sum, mat3_scaled(mat3_outer(v.column[1], v.column[1]), fmax(a[1][1], (real)0)));
  return mat3_plus(sum, mat3_scaled(mat3_outer(v.column[2], v.column[2]), fmax(a[2][2], (real)0)));
}

#endif
