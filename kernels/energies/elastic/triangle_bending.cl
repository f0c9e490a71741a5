// Bending of a thin sheet, one triangle with its three neighbours:
//   E = 1/2 sum_ij K_ij (theta_i - rest_i) (theta_j - rest_j)                                                     [J]
// theta_i: angle across the edge opposite corner i, positive where the neighbour is folded to the side of the
// triangle's normal. K = A G^T D G with the triangle's share of the folds' curvature
//   (k_uu, k_vv, k_uv) = G (theta - rest) = sum_i l_i (m_u^2, m_v^2, m_u m_v)_i (theta_i - rest_i) / (A + A_i),
// l: length of the edge, m: its normal in the plane, A, A_i: areas of the triangle and its neighbour, and the flexural
// rigidity D = diag(B_u, B_v, 2 sqrt(B_u B_v)). Summed over the sheet these curvatures are the second derivative of the
// folded surface in the sense of distributions, so solutions converge. A cylinder whose nodes lie on it costs
// B k^2 / 2 per area on a grid of equal triangles, bent in any direction. On other meshes it costs more: with nodes
// moved by up to 0.3 of an edge 7 to 17 % near equilateral triangles and up to 2.1 times on right ones; on right ones
// cut along both diagonals in turn 1.5 times on the bias. A sheet in equilibrium finds a cheaper shape near it. One
// spring per hinge (Grinspun et al. 2003, "Discrete Shells") costs up to three times even on equal right triangles.
// In equilibrium: strips of irregular triangles (0.2 of an edge) sag 2.5 % too little under their weight, a clamped
// annulus of 10 rings of nearly equilateral ones 1.1 %, one of 20 rings 0.4 %.
// K is made in host/physics/energies/cloth.cpp.
//
// Hessian: Gauss-Newton, sum_ij K_ij grad theta_i grad theta_j^T; what it leaves out vanishes at rest.
#include "energies/elastic/triangle_bending.h"
#include "shared/real.h"

static inline real triangle_bending_stiffness(const TriangleBending* p, const int i, const int j) {
  const int a = min(i, j), b = max(i, j);
  return p->stiffness[a == 0 ? b : a + b + 1];
}

// normals of the triangle and of its neighbour across from corner i, twice their areas long, both of one orientation
static inline void triangle_bending_normals(const real3* x, const int i, real3* own, real3* other) {
  const real3 from = x[(i + 1) % 3], edge = x[(i + 2) % 3] - from;
  *own = cross(edge, x[i] - from);
  *other = cross(x[i + 3] - from, edge);
}

// theta - rest of each edge, 0 where there is no neighbour
static inline void triangle_bending_angles(const TriangleBending* p, const real3* x, real angle[3]) {
  for (int i = 0; i < 3; ++i) {
    angle[i] = 0;
    if (!(triangle_bending_stiffness(p, i, i) > 0)) continue;
    real3 own, other;
    triangle_bending_normals(x, i, &own, &other);
    const real3 edge = x[(i + 2) % 3] - x[(i + 1) % 3];
    // both arguments are |own| |other| times the sine and cosine
    const real sine = dot(cross(other, own), edge) / length(edge);
    angle[i] = atan2(sine, dot(own, other)) - p->rest_angle[i];
  }
}

// d theta_i / dx of the six nodes. The apex of a triangle of height h turns the edge by 1/h per length along its
// normal; the ends of the edge share the opposite by the foot of the height, so that neither a shift nor a turn bends.
static inline void triangle_bending_angle_gradient(const TriangleBending* p, const real3* x, const int i, real3 g[6]) {
  for (int a = 0; a < 6; ++a) g[a] = (real3)(0, 0, 0);
  if (!(triangle_bending_stiffness(p, i, i) > 0)) return;
  real3 normal[2];
  triangle_bending_normals(x, i, &normal[0], &normal[1]);
  const int from = (i + 1) % 3, to = (i + 2) % 3;
  const real3 edge = x[to] - x[from];
  const real square = dot(edge, edge);
  for (int side = 0; side < 2; ++side) {
    const int apex = side == 0 ? i : i + 3;
    const real normal_square = dot(normal[side], normal[side]);
    if (!(normal_square > 0)) continue;  // a triangle without area has no normal to turn
    const real3 by_apex = normal[side] * (sqrt(square) / normal_square);
    const real foot = dot(x[apex] - x[from], edge) / square;
    g[apex] += by_apex;
    g[from] -= (1 - foot) * by_apex;
    g[to] -= foot * by_apex;
  }
}

static inline real triangle_bending_energy(const TriangleBending p, const real3* x, const real3* x0, const real h) {
  real angle[3], sum = 0;
  triangle_bending_angles(&p, x, angle);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) sum += triangle_bending_stiffness(&p, i, j) * angle[i] * angle[j];
  return 0.5 * sum;
}

static inline void triangle_bending_gradient(const TriangleBending p, const real3* x, const real3* x0, const real h,
                                             real3* g) {
  real angle[3];
  triangle_bending_angles(&p, x, angle);
  for (int a = 0; a < 6; ++a) g[a] = (real3)(0, 0, 0);
  for (int i = 0; i < 3; ++i) {
    real3 of_angle[6];
    triangle_bending_angle_gradient(&p, x, i, of_angle);
    real moment = 0;
    for (int j = 0; j < 3; ++j) moment += triangle_bending_stiffness(&p, i, j) * angle[j];
    for (int a = 0; a < 6; ++a) g[a] += moment * of_angle[a];
  }
}

static inline void triangle_bending_hessian(const TriangleBending p, const real3* x, const real3* x0, const real h,
                                            real* H) {
  real d[3][18];  // d theta_i / dx
  for (int i = 0; i < 3; ++i) {
    real3 of_angle[6];
    triangle_bending_angle_gradient(&p, x, i, of_angle);
    for (int a = 0; a < 6; ++a) {
      d[i][3 * a] = of_angle[a].x;
      d[i][3 * a + 1] = of_angle[a].y;
      d[i][3 * a + 2] = of_angle[a].z;
    }
  }
  for (int r = 0; r < 18; ++r) {
    real row[3];  // of (sum_i d_i K_ij)
    for (int j = 0; j < 3; ++j) {
      row[j] = 0;
      for (int i = 0; i < 3; ++i) row[j] += triangle_bending_stiffness(&p, i, j) * d[i][r];
    }
    for (int c = r; c < 18; ++c) {
      const real value = row[0] * d[0][c] + row[1] * d[1][c] + row[2] * d[2][c];
      H[18 * r + c] = value;
      H[18 * c + r] = value;
    }
  }
}

#define TERM triangle_bending
#define PARAMS TriangleBending
#define STENCIL 6
#include "energies/assemble.cl"
