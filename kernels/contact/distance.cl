// Distance between a point and a triangle, two edges, a point and a plane, with the closest points.
// Every kind of closest pair (point-point, point-edge, point-triangle, edge-edge) is tried and the nearest taken, so
// that a wrong decision on a degenerate triangle or parallel edges can cost accuracy of the parameters, never of the
// distance. Result: d = |sum_i c_i x_i|, n = (sum_i c_i x_i) / d;  by the envelope theorem grad_i d = c_i n.
#ifndef PVG_CONTACT_DISTANCE_CL
#define PVG_CONTACT_DISTANCE_CL
#include "shared/real.h"
// a * b - c * d must vanish where a * b == c * d
#pragma OPENCL FP_CONTRACT OFF

typedef struct {
  real c[4];     // coefficients of the four points, first primitive positive
  real3 n;       // unit, from the second primitive to the first; 0 where d = 0
  real d;        // [m]
  int interior;  // closest points lie inside the triangle, or inside both edges
} Distance;

// parameter in [0, 1] of the point of segment ab closest to p, all relative to p (p = 0)
static inline real closest_on_segment(const real3 a, const real3 b) {
  const real3 e = b - a;
  const real ee = dot(e, e);
  // a segment without length: either end
  return ee > 0 ? clamp(-dot(a, e) / ee, 0.0, 1.0) : 0.0;
}

// keeps the nearer of what is known and the difference `diff` with coefficients c0..c3
static inline void keep_nearer(Distance* best, real* best_dd, real3* best_diff, const real3 diff, const real c0,
                               const real c1, const real c2, const real c3) {
  const real dd = dot(diff, diff);
  if (!(dd < *best_dd)) return;
  *best_dd = dd;
  *best_diff = diff;
  best->c[0] = c0;
  best->c[1] = c1;
  best->c[2] = c2;
  best->c[3] = c3;
  best->interior = 0;
}

static inline void finish_distance(Distance* best, const real3 diff) {
  best->d = length(diff);
  best->n = best->d > 0 ? diff / best->d : (real3)(0.0);
}

// x: point, triangle corners. c = (1, -b0, -b1, -b2)
static inline Distance point_triangle_distance(const real3* x) {
  const real3 t0 = x[1] - x[0], t1 = x[2] - x[0], t2 = x[3] - x[0];
  Distance best = {{0, 0, 0, 0}, (real3)(0.0), 0, 0};
  real3 diff = (real3)(NAN);  // stays where a coordinate is NaN: so does the distance
  real dd = INFINITY;
  real s = closest_on_segment(t0, t1);
  keep_nearer(&best, &dd, &diff, -(t0 + s * (t1 - t0)), 1, s - 1, -s, 0);
  s = closest_on_segment(t1, t2);
  keep_nearer(&best, &dd, &diff, -(t1 + s * (t2 - t1)), 1, 0, s - 1, -s);
  s = closest_on_segment(t2, t0);
  keep_nearer(&best, &dd, &diff, -(t2 + s * (t0 - t2)), 1, -s, 0, s - 1);
  // inside the triangle's prism: the foot of the perpendicular, barycentric coordinates as ratios of areas
  const real3 e1 = t1 - t0, e2 = t2 - t0, area = cross(e1, e2);
  const real aa = dot(area, area);
  if (aa > 1e-30 * dot(e1, e1) * dot(e2, e2)) {
    const real b0 = dot(cross(t1, t2), area) / aa, b1 = dot(cross(t2, t0), area) / aa;
    const real b2 = 1 - b0 - b1;
    if (b0 > 0 && b1 > 0 && b2 > 0) {
      keep_nearer(&best, &dd, &diff, -(b0 * t0 + b1 * t1 + b2 * t2), 1, -b0, -b1, -b2);
      best.interior = best.c[1] == -b0 && best.c[2] == -b1;
    }
  }
  finish_distance(&best, diff);
  return best;
}

// x: ends of the first edge, ends of the second. c = (1-s, s, -(1-t), -t)
static inline Distance edge_edge_distance(const real3* x) {
  const real3 e0 = x[1] - x[0], e1 = x[3] - x[2], r = x[2] - x[0];
  Distance best = {{0, 0, 0, 0}, (real3)(0.0), 0, 0};
  real3 diff = (real3)(NAN);  // stays where a coordinate is NaN: so does the distance
  real dd = INFINITY;
  // each end against the other edge
  real t = closest_on_segment(r, r + e1);
  keep_nearer(&best, &dd, &diff, -(r + t * e1), 1, 0, t - 1, -t);
  t = closest_on_segment(r - e0, r - e0 + e1);
  keep_nearer(&best, &dd, &diff, e0 - (r + t * e1), 0, 1, t - 1, -t);
  real s = closest_on_segment(-r, e0 - r);
  keep_nearer(&best, &dd, &diff, s * e0 - r, 1 - s, s, -1, 0);
  s = closest_on_segment(-r - e1, e0 - r - e1);
  keep_nearer(&best, &dd, &diff, s * e0 - r - e1, 1 - s, s, 0, -1);
  // both inside: r + t e1 - s e0 is parallel to e0 x e1
  const real3 normal = cross(e0, e1);
  const real nn = dot(normal, normal);
  if (nn > 1e-30 * dot(e0, e0) * dot(e1, e1)) {
    s = dot(cross(r, e1), normal) / nn;
    t = dot(cross(r, e0), normal) / nn;
    if (s > 0 && s < 1 && t > 0 && t < 1) {
      // one projection onto each edge repairs what rounding did to nearly parallel ones
      s = clamp(dot(r + t * e1, e0) / dot(e0, e0), 0.0, 1.0);
      t = clamp(dot(s * e0 - r, e1) / dot(e1, e1), 0.0, 1.0);
      keep_nearer(&best, &dd, &diff, s * e0 - (r + t * e1), 1 - s, s, t - 1, -t);
      best.interior = best.c[0] == 1 - s && best.c[1] == s && best.c[3] == -t;
    }
  }
  finish_distance(&best, diff);
  return best;
}

// x: point, three points of a plane, counterclockwise seen from outside. d is negative below the plane.
// c = (1, -b0, -b1, -b2) with barycentric coordinates that may be of any size
static inline Distance point_plane_distance(const real3* x) {
  const real3 e1 = x[2] - x[1], e2 = x[3] - x[1], r = x[0] - x[1], area = cross(e1, e2);
  const real aa = dot(area, area), b1 = dot(cross(r, e2), area) / aa, b2 = dot(cross(e1, r), area) / aa;
  const real3 n = normalize(area);
  const Distance distance = {{1, b1 + b2 - 1, -b1, -b2}, n, dot(n, r), 1};
  return distance;
}

// kind: POINT_TRIANGLE (0), EDGE_EDGE (1) or POINT_PLANE (2)
static inline Distance pair_distance(const uint kind, const real3* x) {
  return kind == 0u ? point_triangle_distance(x) : kind == 1u ? edge_edge_distance(x) : point_plane_distance(x);
}

// Are two primitives certainly farther apart than `reach` >= 0 [m]? Two planes across the line between their centres say
// so, for a tenth of what the distance takes:
//   d |n| >= min_b n . x_b - max_a n . x_a > reach |n|,  a of the first, b of the second primitive
// Never so of a half-space, nor where a coordinate is NaN. The last factor covers rounding.
static inline bool is_beyond(const uint kind, const real3* x, const real reach) {
  const int n_first = kind == 1u ? 2 : 1;
  const real3 n = kind == 1u ? 0.5 * (x[2] + x[3] - x[0] - x[1]) : (x[1] + x[2] + x[3]) / 3 - x[0];
  real first = -INFINITY, second = INFINITY;
  for (int i = 0; i < 4; ++i) {
    const real along = dot(n, x[i] - x[0]);
    if (i < n_first)
      first = fmax(first, along);
    else
      second = fmin(second, along);
  }
  const real room = second - first;
  return kind < 2u && room > 0 && room * room > reach * reach * dot(n, n) * 1.000001;
}

#endif
