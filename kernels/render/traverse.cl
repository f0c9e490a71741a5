// Rays against the two-level hierarchy: a tree over instances, below it one tree per mesh. A node's eight boxes are
// tested at once, the near plane picked by the direction's sign; a leaf's four triangles at once. Directions need not
// be of unit length: t counts in directions. The far side of a box is moved out by a few ulp, so that rounding never
// loses a triangle (Ize 2013, "Robust BVH Ray Traversal").
#ifndef PVG_RENDER_TRAVERSE_CL
#define PVG_RENDER_TRAVERSE_CL
#include "render/bvh.h"
#include "render/path.h"
#include "shared/mask.cl"
#include "shared/pocl.h"

// where the trees lie in memory
typedef struct {
  global const float8* top;     // nodes over instances, each 8 x float8
  global const float8* nodes;   // nodes over triangles
  global const float4* blocks;  // leaves, each 10 x float4
  global const Instance* instances;
} Trees;

#define NO_INSTANCE 0xffffffffu

typedef struct {
  float t;        // in directions; on entry the largest allowed
  float u, v;     // weights of the second and third corner
  uint triangle;  // NO_TRIANGLE: nothing was hit
  uint instance;
} Hit;

// what a node's test takes: t of a box's plane at b is b scale + shift
typedef struct {
  float3 near_scale, near_shift, far_scale, far_shift;
  uint near_x, near_y, near_z;  // near planes in a node, the far ones beside them [bytes]
} BoxRay;

// what a leaf's test takes; z is the largest component of the direction, x and y follow right-handed
typedef struct {
  float3 shift, shear;  // origin in that order; direction x and y in units of z, and 1 / direction z
  uint kx, ky, kz;      // rows of a corner in a block [bytes]
} LeafRay;

// Planes are met at t = (b - o) / d = b scale + shift, one instruction each. The near ones are moved to the ray's
// origin and the far ones away from it by more than the rounding of that: 5 ulp of t and 2.5 ulp of o / d.
#define T_SLACK 6e-7f
#define SHIFT_SLACK 3e-7f

ALWAYS_INLINE BoxRay make_box_ray(const float3 origin, const float3 direction) {
  BoxRay r;
  // a component of 0 meets no plane; one next to it does, very far away
  const float3 inverse = 1.0f / copysign(max(fabs(direction), (float3)(1e-20f)), direction);
  const float3 shift = -origin * inverse, slack = SHIFT_SLACK * fabs(shift);
  r.near_scale = (1.0f - T_SLACK) * inverse;
  r.near_shift = (1.0f - T_SLACK) * shift - slack;
  r.far_scale = (1.0f + T_SLACK) * inverse;
  r.far_shift = (1.0f + T_SLACK) * shift + slack;
  r.near_x = as_uint(inverse.x) >> 31 << 5;
  r.near_y = (as_uint(inverse.y) >> 31 << 5) + 64;
  r.near_z = (as_uint(inverse.z) >> 31 << 5) + 128;
  return r;
}

// without branches, as directions have no order
ALWAYS_INLINE LeafRay make_leaf_ray(const float3 origin, const float3 direction) {
  LeafRay r;
  const float3 size = fabs(direction);
  const uint z = size.z >= max(size.x, size.y) ? 2 : (size.x >= size.y ? 0 : 1);
  const uint x = z == 2 ? 0 : z + 1, y = x == 2 ? 0 : x + 1;
  float o[4], d[4];
  vstore4((float4)(origin, 0), 0, o);
  vstore4((float4)(direction, 0), 0, d);
  r.shift = (float3)(o[x], o[y], o[z]);
  r.shear = (float3)(d[x], d[y], 1.0f) / d[z];
  r.kx = 16 * x;
  r.ky = 16 * y;
  r.kz = 16 * z;
  return r;
}

static inline float3 affine_point(global const float* m, const float3 x) {
  return (float3)(m[0] * x.x + m[1] * x.y + m[2] * x.z + m[3], m[4] * x.x + m[5] * x.y + m[6] * x.z + m[7],
                  m[8] * x.x + m[9] * x.y + m[10] * x.z + m[11]);
}
static inline float3 affine_vector(global const float* m, const float3 x) {
  return (float3)(m[0] * x.x + m[1] * x.y + m[2] * x.z, m[4] * x.x + m[5] * x.y + m[6] * x.z,
                  m[8] * x.x + m[9] * x.y + m[10] * x.z);
}

ALWAYS_INLINE float8 plane(global const float8* node, const uint offset) {
  return *(global const float8*)((global const char*)node + offset);
}

// is each box of the node met within (0, t_max)? entry: where
ALWAYS_INLINE int8 boxes_met(global const float8* node, const BoxRay r, const float t_max, float8* entry) {
  const float8 nx = plane(node, r.near_x) * r.near_scale.x + r.near_shift.x;
  const float8 ny = plane(node, r.near_y) * r.near_scale.y + r.near_shift.y;
  const float8 nz = plane(node, r.near_z) * r.near_scale.z + r.near_shift.z;
  const float8 fx = plane(node, r.near_x ^ 32) * r.far_scale.x + r.far_shift.x;
  const float8 fy = plane(node, r.near_y ^ 32) * r.far_scale.y + r.far_shift.y;
  const float8 fz = plane(node, r.near_z ^ 32) * r.far_scale.z + r.far_shift.z;
  // ternaries, not max(): they become one instruction each
  const float8 n = nx > ny ? nx : ny, m = nz > 0.0f ? nz : 0.0f, t0 = n > m ? n : m;
  const float8 f = fx < fy ? fx : fy, g = fz < t_max ? fz : t_max, t1 = f < g ? f : g;
  *entry = t0;
  return t0 <= t1;
}

// bit k: box k of the node is met
ALWAYS_INLINE uint node_hits(global const float8* node, const BoxRay r, const float t_max, float8* entry) {
  return mask8(boxes_met(node, r, t_max, entry));
}

// an edge met exactly belongs to one of its two triangles, which walk along it in opposite directions.
static inline int4 owns_edge(const float4 px, const float4 py, const float4 qx, const float4 qy) {
  return (qy > py) | ((qy == py) & (qx > px));
}

// Four triangles seen along the ray, which becomes the z axis by a shear: corners a, b, c and the areas opposite to
// them.
typedef struct {
  float4 ax, ay, az, bx, by, bz, cx, cy, cz;
  float4 area_a, area_b, area_c;
} Sheared;

ALWAYS_INLINE float4 row(global const float4* corner, const uint offset) {
  return *(global const float4*)((global const char*)corner + offset);
}

// Bits k: the ray passes through triangle k, forward or backward. The signs of three areas decide. Two triangles
// compute the area of their common edge from the same products, so no ray slips through between them (Woop, Benthin,
// Wald 2013); both have a hit on it.
ALWAYS_INLINE int4 shear_block(global const float4* b, const LeafRay r, Sheared* s) {
  s->az = row(b, r.kz) - r.shift.z;
  s->bz = row(b + 3, r.kz) - r.shift.z;
  s->cz = row(b + 6, r.kz) - r.shift.z;
  s->ax = row(b, r.kx) - r.shift.x - r.shear.x * s->az;
  s->ay = row(b, r.ky) - r.shift.y - r.shear.y * s->az;
  s->bx = row(b + 3, r.kx) - r.shift.x - r.shear.x * s->bz;
  s->by = row(b + 3, r.ky) - r.shift.y - r.shear.y * s->bz;
  s->cx = row(b + 6, r.kx) - r.shift.x - r.shear.x * s->cz;
  s->cy = row(b + 6, r.ky) - r.shift.y - r.shear.y * s->cz;
  {
    // a product of its own for each, or an edge's two areas would round differently
#pragma OPENCL FP_CONTRACT OFF
    s->area_a = s->cx * s->by - s->cy * s->bx;
    s->area_b = s->ax * s->cy - s->ay * s->cx;
    s->area_c = s->bx * s->ay - s->by * s->ax;
  }
  // all of one sign; ternaries become one instruction each
  const float4 ab_low = s->area_a < s->area_b ? s->area_a : s->area_b, low = ab_low < s->area_c ? ab_low : s->area_c;
  const float4 ab_high = s->area_a > s->area_b ? s->area_a : s->area_b, high = ab_high > s->area_c ? ab_high : s->area_c;
  return (low >= 0.0f) | (high <= 0.0f);
}

// Is each of these triangles, through which the ray passes where inside, met within (0, t_max)? t, u, v: not finite of
// a degenerate one, which then fails the test
ALWAYS_INLINE int4 triangles_met(const int4 inside, const Sheared s, const float shear_z, const float t_max, float4* t,
                                 float4* u, float4* v) {
  const float4 inverse = 1.0f / (s.area_a + s.area_b + s.area_c);
  *t = (s.area_a * s.az + s.area_b * s.bz + s.area_c * s.cz) * shear_z * inverse;
  *u = s.area_b * inverse;
  *v = s.area_c * inverse;
  return inside & (*t > 0.0f) & (*t < t_max);
}

// bit k: triangle k of the block is met within (0, t_max); t, u, v of each
ALWAYS_INLINE uint block_hits(global const float4* b, const LeafRay r, const float t_max, float4* t, float4* u, float4* v) {
  Sheared s;
  const int4 inside = shear_block(b, r, &s);
  if (!mask4(inside)) return 0;
  return mask4(triangles_met(inside, s, r.shear.z, t_max, t, u, v));
}

// The same where a common edge must count once, for its owner alone; is_front: met against its normal.
static inline uint block_crossings(global const float4* b, const LeafRay r, const float t_max, float4* t,
                                   int4* is_front) {
  Sheared s;
  int4 inside = shear_block(b, r, &s);
  if (!mask4(inside)) return 0;
  inside &= ~((s.area_a == 0.0f) & ~owns_edge(s.bx, s.by, s.cx, s.cy)) &
            ~((s.area_b == 0.0f) & ~owns_edge(s.cx, s.cy, s.ax, s.ay)) &
            ~((s.area_c == 0.0f) & ~owns_edge(s.ax, s.ay, s.bx, s.by));
  const float4 det = s.area_a + s.area_b + s.area_c;
  *t = (s.area_a * s.az + s.area_b * s.bz + s.area_c * s.cz) * r.shear.z / det;
  *is_front = det > 0.0f;
  return mask4(inside & (*t > 0.0f) & (*t < t_max));
}

// What is yet to visit: where it begins above, a child below, so that the order of the numbers is the order of the
// visits (t >= 0).
typedef ulong Visit;
static inline Visit make_visit(const float t, const int child) { return ((ulong)as_uint(t) << 32) | (uint)child; }

// the children that are met (bits of hits): the nearest becomes *current, the others go onto the stack, the nearest on
// top; false: none is met. One to three, the usual, are sorted without branches
ALWAYS_INLINE bool order_children(global const float8* node, uint hits, const float8 entry, Visit* stack, int* size,
                                  int* current) {
  if (!hits) return false;
  global const int* child = (global const int*)(node + 6);
  uint k = lowest_bit(hits);
  hits &= hits - 1;
  if (!hits) {
    *current = child[k];
    return true;
  }
  float t[8] __attribute__((aligned(32)));
  vstore8(entry, 0, t);
  Visit a = make_visit(t[k], child[k]);
  k = lowest_bit(hits);
  hits &= hits - 1;
  const Visit b = make_visit(t[k], child[k]);
  Visit far = a > b ? a : b;
  a = a > b ? b : a;
  if (!hits) {
    stack[(*size)++] = far;
    *current = (int)(uint)a;
    return true;
  }
  k = lowest_bit(hits);
  hits &= hits - 1;
  const Visit c = make_visit(t[k], child[k]);
  Visit middle = far > c ? c : far;
  far = far > c ? far : c;
  const Visit near = a > middle ? middle : a;
  middle = a > middle ? a : middle;
  const int base = *size;
  stack[base] = far;
  stack[base + 1] = middle;
  *size += 2;
  if (!hits) {
    *current = (int)(uint)near;
    return true;
  }
  stack[(*size)++] = near;
  for (; hits; hits &= hits - 1) {
    k = lowest_bit(hits);
    const Visit visit = make_visit(t[k], child[k]);
    int j = (*size)++;
    for (; j > base && stack[j - 1] < visit; --j) stack[j] = stack[j - 1];
    stack[j] = visit;
  }
  *current = (int)(uint)stack[--(*size)];
  return true;
}

ALWAYS_INLINE bool descend(global const float8* node, const BoxRay r, const float t_max, Visit* stack, int* size,
                           int* current) {
  float8 entry;
  const uint hits = node_hits(node, r, t_max, &entry);
  return order_children(node, hits, entry, stack, size, current);
}

// the next visit that begins before t_max; false: none is left
ALWAYS_INLINE bool next_visit(const Visit* stack, const float t_max, int* size, int* current) {
  while (*size > 0) {
    const Visit visit = stack[--(*size)];
    if (as_float((uint)(visit >> 32)) >= t_max) continue;
    *current = (int)(uint)visit;
    return true;
  }
  return false;
}

ALWAYS_INLINE void closest_in_block(global const float4* block, const LeafRay r, const uint instance, Hit* hit) {
  float4 t, u, v;
  uint hits = block_hits(block, r, hit->t, &t, &u, &v);
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

// Closest hit in one mesh before t_max: t, u, v and the bits of the triangle's number; the rays are in the mesh's
// frame. One vector comes back in a register. A struct would be written to memory by parts and read as a whole, which
// waits.
OUT_OF_LINE float4 closest_in_mesh(const Trees trees, const BoxRay* box, const LeafRay* leaf_ray, const int first,
                                   const float t_max) {
  const BoxRay r = *box;
  const LeafRay leaf = *leaf_ray;
  Hit nearest = {t_max, 0, 0, NO_TRIANGLE, 0};
  Visit stack[BVH_STACK];
  int size = 0, current = first;
  do {
    while (current >= 0)
      if (!descend(trees.nodes + (size_t)current * 8, r, nearest.t, stack, &size, &current)) break;
    if (current < 0) closest_in_block(trees.blocks + (size_t)(~current) * 10, leaf, 0, &nearest);
  } while (next_visit(stack, nearest.t, &size, &current));
  return (float4)(nearest.t, nearest.u, nearest.v, as_float(nearest.triangle));
}

// where a visit of a tree begins: at its only leaf, or at its root
ALWAYS_INLINE int first_visit(global const float8* nodes, const int root) {
  global const int* child = (global const int*)(nodes + (size_t)root * 8 + 6);
  return child[0] < 0 && child[1] == BVH_EMPTY ? child[0] : root;
}

// closest hit in what an instance's mesh has below first. world, world_leaf: the ray as unmoved instances take it
ALWAYS_INLINE void closest_in_instance(const Trees trees, const uint i, const int first, const float3 origin,
                                       const float3 direction, const BoxRay* world, const LeafRay* world_leaf,
                                       Hit* hit) {
  global const Instance* instance = trees.instances + i;
  const bool is_moved = !(instance->flags & INSTANCE_UNMOVED);
  const float3 o = is_moved ? affine_point(instance->to_object, origin) : origin;
  const float3 d = is_moved ? affine_vector(instance->to_object, direction) : direction;
  const LeafRay leaf = is_moved ? make_leaf_ray(o, d) : *world_leaf;
  if (first < 0)  // neither a node nor a call
    return closest_in_block(trees.blocks + (size_t)(~first) * 10, leaf, i, hit);
  BoxRay moved;
  if (is_moved) moved = make_box_ray(o, d);
  const float4 found = closest_in_mesh(trees, is_moved ? &moved : world, &leaf, first, hit->t);
  if (!(found.x < hit->t)) return;
  hit->t = found.x;
  hit->u = found.y;
  hit->v = found.z;
  hit->triangle = as_uint(found.w);
  hit->instance = i;
}

// closest hit of the scene but for one instance, NO_INSTANCE: of all; hit->t on entry is the largest allowed
ALWAYS_INLINE void closest_in_others(const Trees trees, const uint left_out, const float3 origin, const float3 direction,
                                     const BoxRay* world, const LeafRay* world_leaf, Hit* hit) {
  Visit stack[BVH_STACK];
  int size = 0, current = first_visit(trees.top, 0);
  do {
    while (current >= 0)
      if (!descend(trees.top + (size_t)current * 8, *world, hit->t, stack, &size, &current)) break;
    if (current >= 0) continue;
    const uint i = (uint)(~current);
    if (i == left_out) continue;
    const int first = first_visit(trees.nodes, (int)trees.instances[i].root);
    closest_in_instance(trees, i, first, origin, direction, world, world_leaf, hit);
  } while (next_visit(stack, hit->t, &size, &current));
}

// closest hit of the scene; hit->t on entry is the largest allowed
ALWAYS_INLINE void closest_hit(const Trees trees, const float3 origin, const float3 direction, Hit* hit) {
  const BoxRay world = make_box_ray(origin, direction);
  const LeafRay world_leaf = make_leaf_ray(origin, direction);
  closest_in_others(trees, NO_INSTANCE, origin, direction, &world, &world_leaf, hit);
}

// bits k: triangle k of the block is met within (0, t_max); t = numerator / det without the division
ALWAYS_INLINE uint block_any(global const float4* b, const LeafRay r, const float t_max) {
  Sheared s;
  const int4 inside = shear_block(b, r, &s);
  if (!mask4(inside)) return 0;
  const float4 det = s.area_a + s.area_b + s.area_c;
  const int4 sign = as_int4(det) & (int4)(0x80000000);
  const float4 t = as_float4(as_int4((s.area_a * s.az + s.area_b * s.bz + s.area_c * s.cz) * r.shear.z) ^ sign);
  return mask4(inside & (t > 0.0f) & (t < t_max * fabs(det)));
}

// one of the children that are met becomes *current, the others go onto the stack, in no order; false: none is met
ALWAYS_INLINE bool descend_any(global const float8* node, const BoxRay r, const float t_max, int* stack, int* size,
                               int* current) {
  float8 entry;
  uint hits = node_hits(node, r, t_max, &entry);
  if (!hits) return false;
  global const int* child = (global const int*)(node + 6);
  *current = child[lowest_bit(hits)];
  for (hits &= hits - 1; hits; hits &= hits - 1) stack[(*size)++] = child[lowest_bit(hits)];
  return true;
}

// is a triangle of the mesh met within (0, t_max)? The rays are in the mesh's frame
OUT_OF_LINE bool any_in_mesh(const Trees trees, const BoxRay* box, const LeafRay* leaf_ray, const int root,
                             const float t_max) {
  const BoxRay r = *box;
  const LeafRay leaf = *leaf_ray;
  int stack[BVH_STACK];
  int size = 0, current = root;
  for (;;) {
    while (current >= 0)
      if (!descend_any(trees.nodes + (size_t)current * 8, r, t_max, stack, &size, &current)) break;
    if (current < 0 && block_any(trees.blocks + (size_t)(~current) * 10, leaf, t_max)) return true;
    if (size == 0) return false;
    current = stack[--size];
  }
}

// the same of all instances that the mask names (MASK_...)
ALWAYS_INLINE bool any_hit(const Trees trees, const float3 origin, const float3 direction, const float t_max,
                           const uint mask) {
  const BoxRay world = make_box_ray(origin, direction);
  const LeafRay world_leaf = make_leaf_ray(origin, direction);
  int stack[BVH_STACK];
  int size = 0, current = first_visit(trees.top, 0);
  for (;;) {
    while (current >= 0)
      if (!descend_any(trees.top + (size_t)current * 8, world, t_max, stack, &size, &current)) break;
    if (current < 0 && (trees.instances[~current].mask & mask)) {
      global const Instance* instance = trees.instances + (~current);
      if (instance->flags & INSTANCE_UNMOVED) {
        if (any_in_mesh(trees, &world, &world_leaf, (int)instance->root, t_max)) return true;
      } else {
        const float3 o = affine_point(instance->to_object, origin), d = affine_vector(instance->to_object, direction);
        const BoxRay moved = make_box_ray(o, d);
        const LeafRay moved_leaf = make_leaf_ray(o, d);
        if (any_in_mesh(trees, &moved, &moved_leaf, (int)instance->root, t_max)) return true;
      }
    }
    if (size == 0) return false;
    current = stack[--size];
  }
}
#endif
