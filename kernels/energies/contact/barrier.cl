// Contact barrier of a pair: E = w m(c) (kappa b(d - offset) + gamma a(d - offset))      [J]
// kappa [Pa], gamma [J/m^2], w area of the pair [m^2], b and m in barrier_law.cl, a in adhesion_law.cl, d the distance.
// Stencil: 4 sites. Hessian: Gauss-Newton, the term of hess d is dropped; projected where the mollifier acts, and no
// less than 0 where adhesion curves downward.
#include "energies/contact/adhesion_law.cl"
#include "energies/contact/barrier_law.cl"
#define EIGEN_N 9
#include "shared/symmetric_eigen.cl"

// kappa b + gamma a and its derivatives [J/m^2, J/m^3, J/m^4]
static inline real contact_value(const Barrier* p, const real gap) {
  const real b = p->stiffness * barrier_value(gap, barrier_range(p->adhesion, p->activation_distance));
  return p->adhesion > 0 ? b + p->adhesion * adhesion_value(gap, p->activation_distance) : b;
}
static inline real contact_slope(const Barrier* p, const real gap) {
  const real b = p->stiffness * barrier_slope(gap, barrier_range(p->adhesion, p->activation_distance));
  return p->adhesion > 0 ? b + p->adhesion * adhesion_slope(gap, p->activation_distance) : b;
}
static inline real contact_curvature(const Barrier* p, const real gap) {
  const real b = p->stiffness * barrier_curvature(gap, barrier_range(p->adhesion, p->activation_distance));
  return p->adhesion > 0 ? fmax(b + p->adhesion * adhesion_curvature(gap, p->activation_distance), 0) : b;
}

// c = |e0 x e1|^2 by the edges e0 = x1 - x0, e1 = x3 - x2 [m^3]
static inline void parallelism_gradient(const real3 e0, const real3 e1, real3* g0, real3* g1) {
  *g0 = 2 * (dot(e1, e1) * e0 - dot(e0, e1) * e1);
  *g1 = 2 * (dot(e0, e0) * e1 - dot(e0, e1) * e0);
}

static inline real barrier_energy(const Barrier p, const real3* x, const real3* x0, const real h) {
  const real gap = pair_distance(p.kind, x).d - p.offset;
  if (gap >= p.activation_distance) return 0;
  // penetration costs without end, even where the mollifier vanishes
  if (!(gap > 0)) return INFINITY;
  return p.area * pair_mollifier(&p, x).value * contact_value(&p, gap);
}

static inline void barrier_gradient(const Barrier p, const real3* x, const real3* x0, const real h, real3* g) {
  const Distance distance = pair_distance(p.kind, x);
  const real gap = distance.d - p.offset;
  const Mollifier m = pair_mollifier(&p, x);
  const real force = p.area * m.value * contact_slope(&p, gap);
  for (int i = 0; i < 4; ++i) g[i] = force * distance.c[i] * distance.n;
  if (m.slope == 0) return;
  real3 g0, g1;
  parallelism_gradient(x[1] - x[0], x[3] - x[2], &g0, &g1);
  const real turn = p.area * m.slope * contact_value(&p, gap);
  g[0] -= turn * g0;
  g[1] += turn * g0;
  g[2] -= turn * g1;
  g[3] += turn * g1;
}

// H += scale (a b^T), 9 x 9, over (r, e0, e1)
static inline void add_outer(real* H, const real scale, const real* a, const real* b) {
  for (int i = 0; i < 9; ++i)
    for (int j = 0; j < 9; ++j) H[9 * i + j] += scale * a[i] * b[j];
}

// H += scale hess c: blocks of e0 and e1
static inline void add_parallelism_hessian(real* H, const real scale, const real3 e0, const real3 e1) {
  const real u[3] = {e0.x, e0.y, e0.z}, v[3] = {e1.x, e1.y, e1.z};
  const real uu = dot(e0, e0), vv = dot(e1, e1), uv = dot(e0, e1);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      const real one = i == j ? 1 : 0;
      const real mixed = 2 * (2 * u[i] * v[j] - v[i] * u[j] - uv * one);
      H[9 * (3 + i) + 3 + j] += scale * 2 * (vv * one - v[i] * v[j]);
      H[9 * (6 + i) + 6 + j] += scale * 2 * (uu * one - u[i] * u[j]);
      H[9 * (3 + i) + 6 + j] += scale * mixed;
      H[9 * (6 + j) + 3 + i] += scale * mixed;
    }
}

// The mollified energy depends on r = x0 - x2, e0 and e1 only: closest difference r + s e0 - t e1. Its Hessian over
// these nine is projected, then carried to the sites, which keeps it positive semi-definite.
static inline void mollified_hessian(const Barrier* p, const real3* x, const Distance* distance, const real gap,
                                     const Mollifier m, real* H) {
  const real3 e0 = x[1] - x[0], e1 = x[3] - x[2];
  real3 g0, g1;
  parallelism_gradient(e0, e1, &g0, &g1);
  const real s = distance->c[1], t = -distance->c[3];
  const real3 n = distance->n;
  const real grad_d[9] = {n.x, n.y, n.z, s * n.x, s * n.y, s * n.z, -t * n.x, -t * n.y, -t * n.z};
  const real grad_c[9] = {0, 0, 0, g0.x, g0.y, g0.z, g1.x, g1.y, g1.z};
  const real b = contact_value(p, gap), slope = contact_slope(p, gap), scale = p->area;
  real Y[81];
  for (int k = 0; k < 81; ++k) Y[k] = 0;
  add_outer(Y, scale * m.value * contact_curvature(p, gap), grad_d, grad_d);
  add_outer(Y, scale * m.slope * slope, grad_d, grad_c);
  add_outer(Y, scale * m.slope * slope, grad_c, grad_d);
  add_outer(Y, scale * m.curvature * b, grad_c, grad_c);
  add_parallelism_hessian(Y, scale * m.slope * b, e0, e1);
  project_to_psd_9(Y);
  // r, e0, e1 by the sites
  const real by_site[3][4] = {{1, 0, -1, 0}, {-1, 1, 0, 0}, {0, 0, -1, 1}};
  for (int i = 0; i < 12; ++i)
    for (int j = 0; j < 12; ++j) {
      real sum = 0;
      for (int k = 0; k < 3; ++k)
        for (int l = 0; l < 3; ++l)
          sum += by_site[k][i / 3] * by_site[l][j / 3] * Y[9 * (3 * k + i % 3) + 3 * l + j % 3];
      H[12 * i + j] = sum;
    }
}

static inline void barrier_hessian(const Barrier p, const real3* x, const real3* x0, const real h, real* H) {
  const Distance distance = pair_distance(p.kind, x);
  const real gap = distance.d - p.offset;
  const Mollifier m = pair_mollifier(&p, x);
  if (m.slope != 0 && gap < p.activation_distance) {
    mollified_hessian(&p, x, &distance, gap, m, H);
    return;
  }
  const real k = p.area * m.value * contact_curvature(&p, gap);
  const real n[3] = {distance.n.x, distance.n.y, distance.n.z};
  for (int i = 0; i < 12; ++i)
    for (int j = 0; j < 12; ++j) H[12 * i + j] = k * (distance.c[i / 3] * n[i % 3]) * (distance.c[j / 3] * n[j % 3]);
}

#define TERM barrier
#define PARAMS Barrier
#define STENCIL 4
#define HESSIAN_WHOLE
#include "energies/assemble.cl"
