// Contact barrier of one point-triangle or edge-edge pair: parameters. The formulas stand in barrier.cl.
#ifndef PVG_ENERGIES_BARRIER_H
#define PVG_ENERGIES_BARRIER_H
#include "shared/types.h"
#define POINT_TRIANGLE 0u
#define EDGE_EDGE 1u
#define POINT_PLANE 2u  // of a half-space
SHARED_BEGIN
typedef struct {
  u32 site[4];  // point, triangle corners or three points of a plane;  or ends of both edges
  u32 kind;     // POINT_TRIANGLE, EDGE_EDGE or POINT_PLANE
  u32 body[2];  // that the first and the second primitive belong to, over all worlds
  u32 world;
  f64 area;                 // w [m^2]; 0: the pair may not cross, but exerts no force
  f64 stiffness;            // kappa [Pa]
  f64 activation_distance;  // d_hat [m]: acts where 0 < d - offset < d_hat
  f64 offset;               // sum of both bodies' contact offsets [m]
  f64 mollifier_threshold;  // of |e0 x e1|^2, 1e-3 |e0|^2 |e1|^2 of the rest lengths [m^4]; 0 for a point and a
                            // triangle
  f64 friction;             // coefficient of the pair of bodies
  f64 adhesion;             // gamma of the pair of bodies [J/m^2]
  f64 unused;
} Barrier;
SHARED_SIZE(Barrier, 96);
SHARED_END
#endif
