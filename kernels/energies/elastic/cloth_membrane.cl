// Woven membrane, one triangle. F = [f_u, f_v] = dx/dX, columns along warp and weft, constant in the triangle:
//   E = A (k_u phi(e_u) + k_v phi(e_v) + k_p e_u e_v + k_s/2 (f_u . f_v)^2)                                      [J]
//   e = |f| - 1,   phi(e) = e^2/2 + S max(e - e_l, 0)^3
// Fibres as springs and the angle between them: after Baraff and Witkin 1998, "Large Steps in Cloth Simulation", with a
// cubic term that lets the modulus grow as 1 + 6 S (e - e_l) beyond the strain e_l.
// Small strains: an orthotropic sheet. With nu = k_p / sqrt(k_u k_v) it has E t = k_u (1 - nu^2) along the warp,
// k_v (1 - nu^2) along the weft, and G t = k_s. k_u = k_v = k with 2 k_s = k - k_p is isotropic, and nu is then Poisson's
// ratio. Without k_p, on the bias (45 degrees)
//   1 / (E t) = (1/k_u + 1/k_v + 1/k_s) / 4.
// Fibres resist compression as much as tension; cloth escapes that by buckling.
// Hessian: the nearest positive semi-definite one of the fibres' energy and of the shear's, by their eigenvalues: Kim
// 2020, "A Finite Element Formulation of Baraff-Witkin Cloth".
#include "energies/elastic/cloth_membrane.h"
#include "energies/mirror_upper.cl"
#include "shared/mat3.cl"

// A fibre shorter than this part of its rest length has no direction: its force fades to zero instead of turning
// without bound.
#define SHORTEST_FIBRE 1e-6

static inline void cloth_membrane_gradients(const ClothMembrane p, real2 b[3]) {
  b[1] = (real2)(p.rest_inverse[0], p.rest_inverse[1]);
  b[2] = (real2)(p.rest_inverse[2], p.rest_inverse[3]);
  b[0] = -(b[1] + b[2]);
}

// f_u and f_v
static inline void cloth_membrane_fibres(const real3* x, const real2 b[3], real3 f[2]) {
  // differences first: coordinates far from the origin cost no digits
  const real3 e1 = x[1] - x[0], e2 = x[2] - x[0];
  f[0] = e1 * b[1].x + e2 * b[2].x;
  f[1] = e1 * b[1].y + e2 * b[2].y;
}

static inline real fibre_energy(const ClothMembrane p, const real strain) {
  const real excess = fmax(strain - p.limit_strain, (real)0);
  return 0.5 * strain * strain + p.stiffening * excess * excess * excess;
}
static inline real fibre_slope(const ClothMembrane p, const real strain) {
  const real excess = fmax(strain - p.limit_strain, (real)0);
  return strain + 3 * p.stiffening * excess * excess;
}
static inline real fibre_curvature(const ClothMembrane p, const real strain) {
  return 1 + 6 * p.stiffening * fmax(strain - p.limit_strain, (real)0);
}

// Both fibre directions: strains and tensions (force per length of the other direction).
typedef struct {
  real strain[2], tension[2];
} Fibres;

static inline Fibres fibres_at(const ClothMembrane p, const real3 f[2]) {
  Fibres at;
  for (int i = 0; i < 2; ++i) at.strain[i] = length(f[i]) - 1;
  at.tension[0] = p.stretch_warp * fibre_slope(p, at.strain[0]) + p.coupling * at.strain[1];
  at.tension[1] = p.stretch_weft * fibre_slope(p, at.strain[1]) + p.coupling * at.strain[0];
  return at;
}

// d2 / df2 of one fibre direction alone: `along` it, and tension / |f| across where that is positive
static inline Mat3 fibre_hessian(const real3 n, const real strain, const real along, const real tension) {
  const real across = fmax(tension, (real)0) / fmax(strain + 1, (real)SHORTEST_FIBRE);
  return mat3_plus(mat3_scaled(mat3_outer(n, n), along - across), mat3_scaled(mat3_identity(), across));
}

static inline real3 fibre_direction(const real3 f) { return f / fmax(length(f), (real)SHORTEST_FIBRE); }

// Adds the nearest positive matrix to d2 (I^2/2), I = f_u . f_v. With g = (f_v, f_u) and T the swap of both halves it
// is g g^T + I T: one positive eigenvalue in the plane of g and T g, and +-I on what is left of (a, +-a).
static inline void shear_add_hessian(const real k, const real3 f[2], Mat3* uu, Mat3* uv, Mat3* vv) {
  const real i = dot(f[0], f[1]), square = dot(f[0], f[0]) + dot(f[1], f[1]);
  if (!(square > 0)) return;
  const real first = 0.5 * (square + sqrt(square * square + 12 * i * i));
  const real3 gu = first * f[1] + i * f[0], gv = first * f[0] + i * f[1];
  const real scale = k * first / (dot(gu, gu) + dot(gv, gv));
  *uu = mat3_plus(*uu, mat3_scaled(mat3_outer(gu, gu), scale));
  *uv = mat3_plus(*uv, mat3_scaled(mat3_outer(gu, gv), scale));
  *vv = mat3_plus(*vv, mat3_scaled(mat3_outer(gv, gv), scale));
  const real sign = i >= 0 ? 1 : -1;
  const real3 w = normalize(f[0] + sign * f[1]);  // its square is at least that of f_u and f_v together
  const Mat3 rest = mat3_plus(mat3_identity(), mat3_scaled(mat3_outer(w, w), -1));
  const real half_i = 0.5 * k * fabs(i);
  *uu = mat3_plus(*uu, mat3_scaled(rest, half_i));
  *uv = mat3_plus(*uv, mat3_scaled(rest, half_i * sign));
  *vv = mat3_plus(*vv, mat3_scaled(rest, half_i));
}

static inline real cloth_membrane_energy(const ClothMembrane p, const real3* x, const real3* x0, const real h) {
  real2 b[3];
  real3 f[2];
  cloth_membrane_gradients(p, b);
  cloth_membrane_fibres(x, b, f);
  const real shear = dot(f[0], f[1]), warp = length(f[0]) - 1, weft = length(f[1]) - 1;
  return p.area * (p.stretch_warp * fibre_energy(p, warp) + p.stretch_weft * fibre_energy(p, weft) +
                   p.coupling * warp * weft + 0.5 * p.shear * shear * shear);
}

static inline void cloth_membrane_gradient(const ClothMembrane p, const real3* x, const real3* x0, const real h,
                                           real3* g) {
  real2 b[3];
  real3 f[2];
  cloth_membrane_gradients(p, b);
  cloth_membrane_fibres(x, b, f);
  const real shear = p.shear * dot(f[0], f[1]);
  const Fibres at = fibres_at(p, f);
  const real3 warp = at.tension[0] * fibre_direction(f[0]) + shear * f[1];
  const real3 weft = at.tension[1] * fibre_direction(f[1]) + shear * f[0];
  for (int a = 0; a < 3; ++a) g[a] = p.area * (b[a].x * warp + b[a].y * weft);
}

static inline void cloth_membrane_hessian(const ClothMembrane p, const real3* x, const real3* x0, const real h,
                                          real* H) {
  real2 b[3];
  real3 f[2];
  cloth_membrane_gradients(p, b);
  cloth_membrane_fibres(x, b, f);
  const Fibres at = fibres_at(p, f);
  const real3 n[2] = {fibre_direction(f[0]), fibre_direction(f[1])};
  Mat3 uu = fibre_hessian(n[0], at.strain[0], p.stretch_warp * fibre_curvature(p, at.strain[0]), at.tension[0]);
  Mat3 vv = fibre_hessian(n[1], at.strain[1], p.stretch_weft * fibre_curvature(p, at.strain[1]), at.tension[1]);
  Mat3 uv = mat3_scaled(mat3_outer(n[0], n[1]), p.coupling);
  shear_add_hessian(p.shear, f, &uu, &uv, &vv);
  const Mat3 vu = mat3_transposed(uv);
  for (int a = 0; a < 3; ++a)
    for (int c = a; c < 3; ++c) {
      const Mat3 same = mat3_plus(mat3_scaled(uu, b[a].x * b[c].x), mat3_scaled(vv, b[a].y * b[c].y));
      const Mat3 mixed = mat3_plus(mat3_scaled(uv, b[a].x * b[c].y), mat3_scaled(vu, b[a].y * b[c].x));
      const Mat3 block = mat3_scaled(mat3_plus(same, mixed), p.area);
      for (int j = 0; j < 3; ++j) {
        H[(3 * a + 0) * 9 + 3 * c + j] = block.column[j].x;
        H[(3 * a + 1) * 9 + 3 * c + j] = block.column[j].y;
        H[(3 * a + 2) * 9 + 3 * c + j] = block.column[j].z;
      }
    }
  mirror_upper(9, H);
}

#define TERM cloth_membrane
#define PARAMS ClothMembrane
#define STENCIL 3
#include "energies/assemble.cl"
