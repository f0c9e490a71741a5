// Singular values of 3 x 3 matrices, F = U diag(sigma) V^T, U and V rotations (determinant +1), so that the smallest
// singular value carries the sign of det(F): sigma.x >= sigma.y >= |sigma.z|. One-sided Jacobi rotations of the columns
// (Hestenes 1958), which keep small singular values accurate. Also: the nearest positive semi-definite matrix.
// Each is for N_LANES matrices; no lane's result depends on the others.
#ifndef PVG_SHARED_SVD_CL
#define PVG_SHARED_SVD_CL
#include "shared/lanes.h"
#include "shared/mat3.cl"

// all [column][row]
typedef struct {
  lanes u[3][3], v[3][3];
  lanes sigma[3];
} LanesSvd3;

// Columns p and q become c p - s q and s p + c q.
static inline void turn_columns(lanes m[3][3], const int p, const int q, const lanes c, const lanes s) {
  for (int k = 0; k < 3; ++k) {
    const lanes mp = m[p][k], mq = m[q][k];
    m[p][k] = c * mp - s * mq;
    m[q][k] = s * mp + c * mq;
  }
}

// Turns columns p and q of B (and of V with it) until they are orthogonal, where they are not already.
static inline lane_mask svd3_orthogonalize(lanes b[3][3], lanes v[3][3], const int p, const int q) {
  const lanes pp = lanes_dot(b[p], b[p]), qq = lanes_dot(b[q], b[q]), pq = lanes_dot(b[p], b[q]);
  const lane_mask turns = pq * pq > 1e-29 * (pp * qq);  // also leaves alone columns that are zero
  // the smaller root of t^2 + 2 t (qq - pp) / (2 pq) = 1, the tangent of the angle
  const lanes more = qq - pp, twice = 2 * pq, root = sqrt(more * more + twice * twice);
  const lanes t = turns ? twice / (more + (more >= 0 ? root : -root)) : (lanes)(0);
  const lanes c = 1 / sqrt(1 + t * t), s = c * t;
  turn_columns(b, p, q, c, s);
  turn_columns(v, p, q, c, s);
  return turns;
}

// Puts the longer column first by a quarter turn, which keeps det(V) = +1.
static inline void svd3_order(lanes b[3][3], lanes v[3][3], const int p, const int q) {
  const lane_mask changes = lanes_dot(b[p], b[p]) < lanes_dot(b[q], b[q]);
  for (int k = 0; k < 3; ++k) {
    const lanes bp = b[p][k], bq = b[q][k], vp = v[p][k], vq = v[q][k];
    b[p][k] = changes ? bq : bp;
    b[q][k] = changes ? -bp : bq;
    v[p][k] = changes ? vq : vp;
    v[q][k] = changes ? -vp : vq;
  }
}

// b becomes a unit vector at right angles to the unit vector a, where `is_wanted`.
static inline void set_perpendicular(const lanes* a, const lane_mask is_wanted, lanes* b) {
  const lane_mask is_along_y = fabs(a[0]) < 0.6 ? (lane_mask)(0) : ~(lane_mask)(0);
  const lanes other[3] = {is_along_y ? (lanes)(0) : (lanes)(1), is_along_y ? (lanes)(1) : (lanes)(0), (lanes)(0)};
  lanes c[3];
  lanes_cross(a, other, c);
  const lanes scale = 1 / sqrt(lanes_dot(c, c));
  for (int k = 0; k < 3; ++k) b[k] = is_wanted ? scale * c[k] : b[k];
}

// f: [column][row]
static inline void lanes_svd3(const lanes f[3][3], LanesSvd3* r) {
  lanes b[3][3];
  for (int c = 0; c < 3; ++c)
    for (int k = 0; k < 3; ++k) {
      b[c][k] = f[c][k];
      r->v[c][k] = (lanes)(c == k ? 1 : 0);
    }
  // converges quadratically: 4 to 6 sweeps; the bound is never met by finite numbers
  for (int sweep = 0; sweep < 16; ++sweep) {
    lane_mask turned = svd3_orthogonalize(b, r->v, 0, 1);
    turned |= svd3_orthogonalize(b, r->v, 0, 2);
    turned |= svd3_orthogonalize(b, r->v, 1, 2);
    if (!ANY_LANE(turned)) break;
  }
  svd3_order(b, r->v, 0, 1);
  svd3_order(b, r->v, 1, 2);
  svd3_order(b, r->v, 0, 1);

  // directions that belong to a zero singular value are free: any that complete the frame
  const lanes first = sqrt(lanes_dot(b[0], b[0]));
  const lane_mask has_first = first > 0;
  for (int k = 0; k < 3; ++k) r->u[0][k] = has_first ? b[0][k] / first : (lanes)(k == 0 ? 1 : 0);
  const lanes along = lanes_dot(r->u[0], b[1]);
  for (int k = 0; k < 3; ++k) r->u[1][k] = b[1][k] - along * r->u[0][k];
  const lanes second = sqrt(lanes_dot(r->u[1], r->u[1]));
  const lane_mask is_free = second > 1e-14 * first ? (lane_mask)(0) : ~(lane_mask)(0);
  for (int k = 0; k < 3; ++k) r->u[1][k] /= second;
  if (ANY_LANE(is_free)) set_perpendicular(r->u[0], is_free, r->u[1]);
  lanes_cross(r->u[0], r->u[1], r->u[2]);
  r->sigma[0] = first;
  r->sigma[1] = lanes_dot(r->u[1], b[1]);
  r->sigma[2] = lanes_dot(r->u[2], b[2]);
}

// One Jacobi rotation of the symmetric matrix A in the plane (p, q), r the third index: A <- R^T A R, V <- V R.
static inline void symmetric3_rotate(lanes a[3][3], lanes v[3][3], const int p, const int q, const int r) {
  const lanes more = a[q][q] - a[p][p], twice = 2 * a[p][q], root = sqrt(more * more + twice * twice);
  // root is 0 beside a tiny `twice` whose square underflows
  const lanes t = twice != 0 && root > 0 ? twice / (more + (more >= 0 ? root : -root)) : (lanes)(0);
  const lanes c = 1 / sqrt(1 + t * t), s = c * t;
  a[p][p] -= t * a[p][q];
  a[q][q] += t * a[p][q];
  a[p][q] = a[q][p] = (lanes)(0);
  const lanes rp = a[r][p], rq = a[r][q];
  a[r][p] = a[p][r] = c * rp - s * rq;
  a[r][q] = a[q][r] = s * rp + c * rq;
  turn_columns(v, p, q, c, s);
}

// M becomes the nearest positive semi-definite matrix to the symmetric M: negative eigenvalues become zero.
static inline void lanes_set_nearest_positive(lanes m[3][3]) {
  const lanes minor2 = m[0][0] * m[1][1] - m[1][0] * m[1][0];
  lanes cross_product[3];
  lanes_cross(m[1], m[2], cross_product);
  // positive leading minors: positive definite already (Sylvester), which is the rule
  const lanes least = fmin(fmin(m[0][0], minor2), lanes_dot(m[0], cross_product));
  const lane_mask is_positive = least > 0;
  const lane_mask changes = is_positive ? (lane_mask)(0) : ~(lane_mask)(0);
  if (!ANY_LANE(changes)) return;
  lanes a[3][3], v[3][3];
  for (int c = 0; c < 3; ++c)
    for (int k = 0; k < 3; ++k) {
      a[c][k] = m[c][k];
      v[c][k] = (lanes)(c == k ? 1 : 0);
    }
  for (int sweep = 0; sweep < 8; ++sweep) {
    symmetric3_rotate(a, v, 0, 1, 2);
    symmetric3_rotate(a, v, 0, 2, 1);
    symmetric3_rotate(a, v, 1, 2, 0);
  }
  for (int c = 0; c < 3; ++c)
    for (int k = 0; k < 3; ++k) {
      lanes sum = (lanes)(0);
      for (int e = 0; e < 3; ++e) sum += fmax(a[e][e], (lanes)(0)) * v[e][c] * v[e][k];
      m[c][k] = changes ? sum : m[c][k];
    }
}

// ---- of one matrix

typedef struct {
  Mat3 u, v;
  real3 sigma;
} Svd3;

static inline Mat3 first_lane(lanes m[3][3]) {
  return mat3_of_columns((real3)(LANE(m[0][0], 0), LANE(m[0][1], 0), LANE(m[0][2], 0)),
                         (real3)(LANE(m[1][0], 0), LANE(m[1][1], 0), LANE(m[1][2], 0)),
                         (real3)(LANE(m[2][0], 0), LANE(m[2][1], 0), LANE(m[2][2], 0)));
}

static inline Svd3 svd3(const Mat3 f) {
  lanes b[3][3];
  for (int c = 0; c < 3; ++c) {
    b[c][0] = (lanes)(f.column[c].x);
    b[c][1] = (lanes)(f.column[c].y);
    b[c][2] = (lanes)(f.column[c].z);
  }
  LanesSvd3 s;
  lanes_svd3(b, &s);
  Svd3 r;
  r.u = first_lane(s.u);
  r.v = first_lane(s.v);
  r.sigma = (real3)(LANE(s.sigma[0], 0), LANE(s.sigma[1], 0), LANE(s.sigma[2], 0));
  return r;
}

#endif
