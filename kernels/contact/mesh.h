// The collision surfaces of all worlds, as the contact kernels read them. Sorted by world; a site is a row of x.
#ifndef PVG_CONTACT_MESH_H
#define PVG_CONTACT_MESH_H
#include "shared/types.h"
SHARED_BEGIN
typedef struct {
  u32 site;
  u32 body;  // over all worlds
  f64 area;  // share of the rest surface that this point stands for [m^2]
} CollisionPoint;
SHARED_SIZE(CollisionPoint, 16);

typedef struct {
  u32 site[2];
  u32 body;
  u32 is_flat;      // inside a plane face of a body that stays plane: guards against crossing, exerts no force
  f64 area;         // share of the rest surface that this edge stands for [m^2]
  f64 rest_length;  // [m]
} CollisionEdge;
SHARED_SIZE(CollisionEdge, 32);

typedef struct {
  u32 site[3];
  u32 body;
} CollisionTriangle;
SHARED_SIZE(CollisionTriangle, 16);

typedef struct {
  u32 world;
  u32 index;   // within its world, row and column of the world's table of pairs
  f64 offset;  // contact acts this far outside the surface [m]
  u32 is_half_space;
  u32 unused[3];
} CollisionBodyRow;
SHARED_SIZE(CollisionBodyRow, 32);

typedef struct {
  u32 first_pair;  // where the world's table of body pairs begins; n_bodies^2 entries
  u32 n_bodies;
  f64 activation_distance;  // d_hat [m]
  f64 stiffness;            // kappa [Pa]
  f64 friction_velocity;    // epsilon_v [m/s]
} CollisionWorld;
SHARED_SIZE(CollisionWorld, 32);
SHARED_END
#endif
