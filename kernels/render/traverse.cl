// Rays against the two-level hierarchy: a tree over instances, below it one tree per mesh. A node's eight boxes are
// tested at once, the near plane picked by the direction's sign; a leaf's four triangles at once. Directions need not
// be of unit length: t counts in directions. The far side of a box is moved out by a few ulp, so that rounding never
// loses a triangle (Ize 2013, "Robust BVH Ray Traversal").
#ifndef PVG_RENDER_TRAVERSE_CL
#define PVG_RENDER_TRAVERSE_CL
#include "render/bvh.h"
#include "render/path.h"
#include "shared/mask.cl"

// where the trees lie in memory
typedef struct {
  global const float8* top;     // nodes over instances, each 8 x float8
  global const float8* nodes;   // nodes over triangles
  global const float4* blocks;  // leaves, each 10 x float4
  global const Instance* instances;
} Trees;

typedef struct {
  float t;        // in directions; on entry the largest allowed
  float u, v;     // weights of the second and third corner
  uint triangle;  // NO_TRIANGLE: nothing was hit
  uint instance;
} Hit;

typedef struct {
  float3 origin, direction, inverse;
  int near_x, near_y, near_z;  // rows of a node
  int kx, ky, kz;              // z: the largest component of the direction; x, y: so that the three are right-handed
  float3 shift, shear;         // origin in that order; shear.z = 1 / direction z
} BoxRay;

inline float safe_inverse(const float x) { return 1.0f / (fabs(x) > 1e-20f ? x : (x < 0 ? -1e-20f : 1e-20f)); }

inline BoxRay make_ray(const float3 origin, const float3 direction) {
  BoxRay r;
  r.origin = origin;
  r.direction = direction;
  r.inverse = (float3)(safe_inverse(direction.x), safe_inverse(direction.y), safe_inverse(direction.z));
  r.near_x = r.inverse.x < 0 ? 1 : 0;
  r.near_y = r.inverse.y < 0 ? 3 : 2;
  r.near_z = r.inverse.z < 0 ? 5 : 4;
  const float3 size = fabs(direction);
  if (size.z >= size.x && size.z >= size.y) {
    r.kz = 2;
    r.shift = origin;
    r.shear = direction;
  } else if (size.x >= size.y) {
    r.kz = 0;
    r.shift = origin.yzx;
    r.shear = direction.yzx;
  } else {
    r.kz = 1;
    r.shift = origin.zxy;
    r.shear = direction.zxy;
  }
  r.kx = r.kz == 2 ? 0 : r.kz + 1;
  r.ky = r.kx == 2 ? 0 : r.kx + 1;
  r.shear = (float3)(r.shear.x, r.shear.y, 1.0f) / r.shear.z;
  return r;
}

inline float3 affine_point(global const float* m, const float3 x) {
  return (float3)(m[0] * x.x + m[1] * x.y + m[2] * x.z + m[3], m[4] * x.x + m[5] * x.y + m[6] * x.z + m[7],
                  m[8] * x.x + m[9] * x.y + m[10] * x.z + m[11]);
}
inline float3 affine_vector(global const float* m, const float3 x) {
  return (float3)(m[0] * x.x + m[1] * x.y + m[2] * x.z, m[4] * x.x + m[5] * x.y + m[6] * x.z,
                  m[8] * x.x + m[9] * x.y + m[10] * x.z);
}

// bit k: box k of the node is met within (0, t_max); entry: where
inline uint node_hits(global const float8* node, const BoxRay r, const float t_max, float8* entry) {
  const float8 nx = (node[r.near_x] - r.origin.x) * r.inverse.x, fx = (node[r.near_x ^ 1] - r.origin.x) * r.inverse.x;
  const float8 ny = (node[r.near_y] - r.origin.y) * r.inverse.y, fy = (node[r.near_y ^ 1] - r.origin.y) * r.inverse.y;
  const float8 nz = (node[r.near_z] - r.origin.z) * r.inverse.z, fz = (node[r.near_z ^ 1] - r.origin.z) * r.inverse.z;
  // ternaries, not max(): they become one instruction each
  float8 t0 = nx > ny ? nx : ny;
  t0 = t0 > nz ? t0 : nz;
  t0 = t0 > 0.0f ? t0 : 0.0f;
  float8 t1 = fx < fy ? fx : fy;
  t1 = (t1 < fz ? t1 : fz) * 1.0000006f;
  t1 = t1 < t_max ? t1 : t_max;
  *entry = t0;
  return mask8(t0 <= t1);
}

// an edge met exactly belongs to one of its two triangles, which walk along it in opposite directions.
inline int4 owns_edge(const float4 px, const float4 py, const float4 qx, const float4 qy) {
  return (qy > py) | ((qy == py) & (qx > px));
}

// Bit k: triangle k of the block is met within (0, t_max); t, u, v of each; is_front: met against its normal. The ray
// becomes the z axis by a shear, then the signs of three areas decide. Two triangles compute the area of their common
// edge from the same products, so no ray slips through between them (Woop, Benthin, Wald 2013). Both have a hit on it,
// or with counts_once only its owner.
inline uint block_hits(global const float4* b, const BoxRay r, const float t_max, const bool counts_once, float4* t,
                       float4* u, float4* v, int4* is_front) {
#pragma OPENCL FP_CONTRACT OFF
  const float4 az = b[r.kz] - r.shift.z, bz = b[3 + r.kz] - r.shift.z, cz = b[6 + r.kz] - r.shift.z;
  const float4 ax = b[r.kx] - r.shift.x - r.shear.x * az, ay = b[r.ky] - r.shift.y - r.shear.y * az;
  const float4 bx = b[3 + r.kx] - r.shift.x - r.shear.x * bz, by = b[3 + r.ky] - r.shift.y - r.shear.y * bz;
  const float4 cx = b[6 + r.kx] - r.shift.x - r.shear.x * cz, cy = b[6 + r.ky] - r.shift.y - r.shear.y * cz;
  const float4 area_a = cx * by - cy * bx, area_b = ax * cy - ay * cx, area_c = bx * ay - by * ax;
  const float4 det = area_a + area_b + area_c;
  int4 inside = ((area_a >= 0.0f) & (area_b >= 0.0f) & (area_c >= 0.0f)) |
                ((area_a <= 0.0f) & (area_b <= 0.0f) & (area_c <= 0.0f));
  if (!mask4(inside)) return 0;
  const int4 edge_a = area_a == 0.0f, edge_b = area_b == 0.0f, edge_c = area_c == 0.0f;
  if (counts_once && mask4(inside & (edge_a | edge_b | edge_c))) {
    inside &= ~(edge_a & ~owns_edge(bx, by, cx, cy)) & ~(edge_b & ~owns_edge(cx, cy, ax, ay)) &
              ~(edge_c & ~owns_edge(ax, ay, bx, by));
  }
  const float4 inverse = 1.0f / det;  // of a degenerate triangle not finite: t then fails its test
  *t = (area_a * az + area_b * bz + area_c * cz) * r.shear.z * inverse;
  *u = area_b * inverse;
  *v = area_c * inverse;
  *is_front = det > 0.0f;
  return mask4(inside & (*t > 0.0f) & (*t < t_max));
}

// children onto the stack, the nearest on top
inline int push_sorted(uint hits, global const int* child, const float8 entry, int* stack, float* stack_t, int size) {
  float t[8];
  vstore8(entry, 0, t);
  const int base = size;
  for (; hits; hits &= hits - 1) {
    const uint k = lowest_bit(hits);
    int j = size++;
    while (j > base && stack_t[j - 1] < t[k]) {
      stack_t[j] = stack_t[j - 1];
      stack[j] = stack[j - 1];
      --j;
    }
    stack_t[j] = t[k];
    stack[j] = child[k];
  }
  return size;
}

inline void closest_in_block(global const float4* block, const BoxRay r, const uint instance, Hit* hit) {
  float4 t, u, v;
  int4 is_front;
  uint hits = block_hits(block, r, hit->t, false, &t, &u, &v, &is_front);
  if (!hits) return;
  float ts[4], us[4], vs[4];
  vstore4(t, 0, ts);
  vstore4(u, 0, us);
  vstore4(v, 0, vs);
  for (; hits; hits &= hits - 1) {
    const uint k = lowest_bit(hits);
    if (ts[k] >= hit->t) continue;
    hit->t = ts[k];
    hit->u = us[k];
    hit->v = vs[k];
    hit->triangle = ((global const uint*)(block + 9))[k];
    hit->instance = instance;
  }
}

// closest hit in one mesh; r in the mesh's frame
inline void closest_in_mesh(const Trees trees, const BoxRay r, const uint instance, const int root, Hit* hit) {
  int stack[BVH_STACK];
  float stack_t[BVH_STACK];
  int size = 0, current = root;
  for (;;) {
    if (current >= 0) {
      global const float8* node = trees.nodes + (size_t)current * 8;
      float8 entry;
      const uint hits = node_hits(node, r, hit->t, &entry);
      global const int* child = (global const int*)(node + 6);
      if (hits && !(hits & (hits - 1))) {
        current = child[lowest_bit(hits)];
        continue;
      }
      size = push_sorted(hits, child, entry, stack, stack_t, size);
    } else {
      closest_in_block(trees.blocks + (size_t)(~current) * 10, r, instance, hit);
    }
    do {
      if (size == 0) return;
      --size;
    } while (stack_t[size] >= hit->t);
    current = stack[size];
  }
}

// closest hit of the scene; hit->t on entry is the largest allowed
inline void closest_hit(const Trees trees, const float3 origin, const float3 direction, Hit* hit) {
  const BoxRay world = make_ray(origin, direction);
  int stack[BVH_STACK];
  float stack_t[BVH_STACK];
  int size = 0, current = 0;
  for (;;) {
    if (current >= 0) {
      global const float8* node = trees.top + (size_t)current * 8;
      float8 entry;
      const uint hits = node_hits(node, world, hit->t, &entry);
      size = push_sorted(hits, (global const int*)(node + 6), entry, stack, stack_t, size);
    } else {
      const uint i = (uint)(~current);
      global const Instance* instance = trees.instances + i;
      const BoxRay r =
          make_ray(affine_point(instance->to_object, origin), affine_vector(instance->to_object, direction));
      closest_in_mesh(trees, r, i, (int)instance->root, hit);
    }
    do {
      if (size == 0) return;
      --size;
    } while (stack_t[size] >= hit->t);
    current = stack[size];
  }
}
#endif
