// Sixteen rays that go much the same way, closest hit of each: they walk the trees together, so that a node is tested
// once for all of them, and a triangle against all at once. The arithmetic of a ray and a triangle is that of
// traverse.cl, so hits have the same bits; of two triangles at the same t either may be found.
// A node's box is met where it may be met by any ray whose origin and direction lie between the least and the
// greatest of the packet (interval arithmetic: Wald et al. 2007, "Ray Tracing Deformable Scenes Using Dynamic
// Bounding Volume Hierarchies"):
//   t >= min((b - o) / d_least, (b - o) / d_greatest), o the greatest origin where the axis is met forward, and so on.
// That needs directions of the same signs. Where they differ, in the world or in the frame of a mesh, and where rays
// spread too far, each goes alone.
#ifndef PVG_RENDER_LANES_PACKET_CL
#define PVG_RENDER_LANES_PACKET_CL
#include "render/traverse.cl"

// largest spread of a packet's directions, in units of their largest component: beyond it a node that the packet may
// meet is met by few of its rays. By judgement, not tuned
#define PACKET_SPREAD 0.05f

typedef struct {
  float16 x, y, z;
} Packet;  // vectors of sixteen rays

typedef struct {
  float16 t, u, v;  // as in Hit
  uint16 triangle, instance;
} PacketHit;

// what a node's test takes
typedef struct {
  float3 near_origin, far_origin;  // of all origins those that meet the near planes first and the far ones last
  float3 least, greatest;          // 1 / direction
  uint near_x, near_y, near_z;     // as in BoxRay
} BoxPacket;

// what a leaf's test takes, as LeafRay
typedef struct {
  Packet shift, shear;
  uint kx, ky, kz;
} LeafPacket;

static inline float least_of(const float16 a) {
  const float8 b = a.lo < a.hi ? a.lo : a.hi;
  const float4 c = b.lo < b.hi ? b.lo : b.hi;
  const float2 d = c.lo < c.hi ? c.lo : c.hi;
  return d.x < d.y ? d.x : d.y;
}
static inline float greatest_of(const float16 a) {
  const float8 b = a.lo > a.hi ? a.lo : a.hi;
  const float4 c = b.lo > b.hi ? b.lo : b.hi;
  const float2 d = c.lo > c.hi ? c.lo : c.hi;
  return d.x > d.y ? d.x : d.y;
}
static inline bool is_any(const int16 is_true) { return mask16(is_true) != 0; }

ALWAYS_INLINE float16 inverse_of(const float16 d) {
  return 1.0f / copysign(max(fabs(d), (float16)(1e-20f)), d);  // as in make_box_ray
}

// false: the directions of an axis have both signs
ALWAYS_INLINE bool make_box_packet(const Packet origin, const Packet direction, BoxPacket* p) {
  const float16 x = inverse_of(direction.x), y = inverse_of(direction.y), z = inverse_of(direction.z);
  p->least = (float3)(least_of(x), least_of(y), least_of(z));
  p->greatest = (float3)(greatest_of(x), greatest_of(y), greatest_of(z));
  const float3 low = (float3)(least_of(origin.x), least_of(origin.y), least_of(origin.z));
  const float3 high = (float3)(greatest_of(origin.x), greatest_of(origin.y), greatest_of(origin.z));
  const int3 is_backward = p->least < 0.0f;
  p->near_origin = is_backward ? low : high;
  p->far_origin = is_backward ? high : low;
  p->near_x = (as_uint(p->least.x) >> 31 << 5);
  p->near_y = (as_uint(p->least.y) >> 31 << 5) + 64;
  p->near_z = (as_uint(p->least.z) >> 31 << 5) + 128;
  return p->least.x * p->greatest.x > 0.0f && p->least.y * p->greatest.y > 0.0f && p->least.z * p->greatest.z > 0.0f;
}

// which component of each direction is the largest, as in make_leaf_ray: x, z, else y
ALWAYS_INLINE void find_largest_components(const Packet direction, int16* is_x, int16* is_z) {
  const float16 size_x = fabs(direction.x), size_y = fabs(direction.y), size_z = fabs(direction.z);
  *is_z = size_z >= max(size_x, size_y);
  *is_x = ~*is_z & (size_x >= size_y);
}

// false: the largest component is not the same one of all directions
ALWAYS_INLINE bool make_leaf_packet(const Packet origin, const Packet direction, LeafPacket* p) {
  int16 is_x, is_z;
  find_largest_components(direction, &is_x, &is_z);
  const uint n_z = mask16(is_z), n_x = mask16(is_x);
  if (n_z == 0xffffu) {
    const Packet shift = {origin.x, origin.y, origin.z};
    const Packet shear = {direction.x / direction.z, direction.y / direction.z, 1.0f / direction.z};
    const LeafPacket made = {shift, shear, 0, 16, 32};
    *p = made;
    return true;
  }
  if (n_x == 0xffffu) {
    const Packet shift = {origin.y, origin.z, origin.x};
    const Packet shear = {direction.y / direction.x, direction.z / direction.x, 1.0f / direction.x};
    const LeafPacket made = {shift, shear, 16, 32, 0};
    *p = made;
    return true;
  }
  const Packet shift = {origin.z, origin.x, origin.y};
  const Packet shear = {direction.z / direction.y, direction.x / direction.y, 1.0f / direction.y};
  const LeafPacket made = {shift, shear, 32, 0, 16};
  *p = made;
  return n_z == 0 && n_x == 0;
}

ALWAYS_INLINE float8 least_of_products(const float8 a, const float least, const float greatest) {
  const float8 b = a * least, c = a * greatest;
  return b < c ? b : c;
}
ALWAYS_INLINE float8 greatest_of_products(const float8 a, const float least, const float greatest) {
  const float8 b = a * least, c = a * greatest;
  return b > c ? b : c;
}

// bit k: box k of the node may be met by a ray of the packet within (0, t_max); entry: not before
ALWAYS_INLINE uint packet_node_hits(global const float8* node, const BoxPacket p, const float t_max, float8* entry) {
  const float8 nx = least_of_products(plane(node, p.near_x) - p.near_origin.x, p.least.x, p.greatest.x);
  const float8 ny = least_of_products(plane(node, p.near_y) - p.near_origin.y, p.least.y, p.greatest.y);
  const float8 nz = least_of_products(plane(node, p.near_z) - p.near_origin.z, p.least.z, p.greatest.z);
  const float8 fx = greatest_of_products(plane(node, p.near_x ^ 32) - p.far_origin.x, p.least.x, p.greatest.x);
  const float8 fy = greatest_of_products(plane(node, p.near_y ^ 32) - p.far_origin.y, p.least.y, p.greatest.y);
  const float8 fz = greatest_of_products(plane(node, p.near_z ^ 32) - p.far_origin.z, p.least.z, p.greatest.z);
  const float8 nxy = nx > ny ? nx : ny, n = (nxy > nz ? nxy : nz) * (1.0f - T_SLACK), t0 = n > 0.0f ? n : 0.0f;
  const float8 fxy = fx < fy ? fx : fy, f = (fxy < fz ? fxy : fz) * (1.0f + T_SLACK), t1 = f < t_max ? f : t_max;
  *entry = t0;
  return mask8(t0 <= t1);
}

// a triangle seen along each ray, as Sheared in traverse.cl
typedef struct {
  float16 az, bz, cz, area_a, area_b, area_c;
} ShearedPacket;

// which rays pass through the triangle, as in shear_block; a, b, c: its corners from the rays' origins, in their axes
ALWAYS_INLINE int16 shear_triangle(const Packet a, const Packet b, const Packet c, const Packet shear,
                                   ShearedPacket* s) {
  const float16 ax = a.x - shear.x * a.z, ay = a.y - shear.y * a.z;
  const float16 bx = b.x - shear.x * b.z, by = b.y - shear.y * b.z;
  const float16 cx = c.x - shear.x * c.z, cy = c.y - shear.y * c.z;
  s->az = a.z;
  s->bz = b.z;
  s->cz = c.z;
  {
#pragma OPENCL FP_CONTRACT OFF
    s->area_a = cx * by - cy * bx;
    s->area_b = ax * cy - ay * cx;
    s->area_c = bx * ay - by * ax;
  }
  const float16 ab_low = s->area_a < s->area_b ? s->area_a : s->area_b;
  const float16 low = ab_low < s->area_c ? ab_low : s->area_c;
  const float16 ab_high = s->area_a > s->area_b ? s->area_a : s->area_b;
  const float16 high = ab_high > s->area_c ? ab_high : s->area_c;
  return (low >= 0.0f) | (high <= 0.0f);
}

// the same triangle's hits, as in block_hits; where one is nearer than what the ray met so far. Without branches: in
// most leaves some rays meet a triangle, and which do no processor foresees
ALWAYS_INLINE int16 keep_nearer(const int16 inside, const ShearedPacket s, const float16 shear_z, const uint triangle,
                                const uint instance, PacketHit* hit) {
  const float16 inverse = 1.0f / (s.area_a + s.area_b + s.area_c);
  const float16 t = (s.area_a * s.az + s.area_b * s.bz + s.area_c * s.cz) * shear_z * inverse;
  const int16 is_nearer = inside & (t > 0.0f) & (t < hit->t);
  hit->t = is_nearer ? t : hit->t;
  hit->u = is_nearer ? s.area_b * inverse : hit->u;
  hit->v = is_nearer ? s.area_c * inverse : hit->v;
  hit->triangle = is_nearer ? (uint16)(triangle) : hit->triangle;
  hit->instance = is_nearer ? (uint16)(instance) : hit->instance;
  return is_nearer;
}

// triangle number k of the block; true: a ray meets it before what it met so far
ALWAYS_INLINE bool closest_of_packet_in_triangle(global const float* block, const LeafPacket r, const uint triangle,
                                                 const uint instance, PacketHit* hit) {
  global const float *x = block + r.kx / 4, *y = block + r.ky / 4, *z = block + r.kz / 4;
  const Packet a = {x[0] - r.shift.x, y[0] - r.shift.y, z[0] - r.shift.z};
  const Packet b = {x[12] - r.shift.x, y[12] - r.shift.y, z[12] - r.shift.z};
  const Packet c = {x[24] - r.shift.x, y[24] - r.shift.y, z[24] - r.shift.z};
  ShearedPacket s;
  const int16 inside = shear_triangle(a, b, c, r.shear, &s);
  return is_any(keep_nearer(inside, s, r.shear.z, triangle, instance, hit));
}

// true: a ray has met something nearer
ALWAYS_INLINE bool closest_of_packet_in_block(global const float4* block, const LeafPacket r, const uint instance,
                                              PacketHit* hit) {
  global const uint* triangles = (global const uint*)(block + 9);
  bool is_found = false;
  for (uint k = 0; k < 4; ++k)
    is_found |= closest_of_packet_in_triangle((global const float*)block + k, r, triangles[k], instance, hit);
  return is_found;
}

// closest hits in one mesh, in whose frame the rays are
OUT_OF_LINE void closest_of_packet_in_mesh(const Trees trees, const BoxPacket* box, const LeafPacket* leaf,
                                           const int first, const uint instance, PacketHit* hit) {
  const BoxPacket p = *box;
  Visit stack[BVH_STACK];
  int size = 0, current = first;
  float t_max = greatest_of(hit->t);
  do {
    while (current >= 0) {
      global const float8* node = trees.nodes + (size_t)current * 8;
      float8 entry;
      const uint hits = packet_node_hits(node, p, t_max, &entry);
      if (!order_children(node, hits, entry, stack, &size, &current)) break;
    }
    if (current < 0 && closest_of_packet_in_block(trees.blocks + (size_t)(~current) * 10, *leaf, instance, hit))
      t_max = greatest_of(hit->t);
  } while (next_visit(stack, t_max, &size, &current));
}

ALWAYS_INLINE Packet affine_points(global const float* m, const Packet p) {
  const Packet q = {m[0] * p.x + m[1] * p.y + m[2] * p.z + m[3], m[4] * p.x + m[5] * p.y + m[6] * p.z + m[7],
                    m[8] * p.x + m[9] * p.y + m[10] * p.z + m[11]};
  return q;
}
ALWAYS_INLINE Packet affine_vectors(global const float* m, const Packet p) {
  const Packet q = {m[0] * p.x + m[1] * p.y + m[2] * p.z, m[4] * p.x + m[5] * p.y + m[6] * p.z,
                    m[8] * p.x + m[9] * p.y + m[10] * p.z};
  return q;
}

// a packet's numbers one by one
typedef struct {
  float origin[3][PACKET], direction[3][PACKET], t[PACKET], u[PACKET], v[PACKET];
  uint triangle[PACKET], instance[PACKET];
} Lanes;

ALWAYS_INLINE void store_hits(const PacketHit hit, Lanes* lanes) {
  vstore16(hit.t, 0, lanes->t);
  vstore16(hit.u, 0, lanes->u);
  vstore16(hit.v, 0, lanes->v);
  vstore16(hit.triangle, 0, lanes->triangle);
  vstore16(hit.instance, 0, lanes->instance);
}
ALWAYS_INLINE PacketHit load_hits(const Lanes* lanes) {
  const PacketHit hit = {vload16(0, lanes->t), vload16(0, lanes->u), vload16(0, lanes->v),
                         vload16(0, lanes->triangle), vload16(0, lanes->instance)};
  return hit;
}

ALWAYS_INLINE void set_ray(Lanes* lanes, const uint k, const float3 origin, const float3 direction) {
  lanes->origin[0][k] = origin.x;
  lanes->origin[1][k] = origin.y;
  lanes->origin[2][k] = origin.z;
  lanes->direction[0][k] = direction.x;
  lanes->direction[1][k] = direction.y;
  lanes->direction[2][k] = direction.z;
}
ALWAYS_INLINE float3 lane_origin(const Lanes* lanes, const uint k) {
  return (float3)(lanes->origin[0][k], lanes->origin[1][k], lanes->origin[2][k]);
}
ALWAYS_INLINE float3 lane_direction(const Lanes* lanes, const uint k) {
  return (float3)(lanes->direction[0][k], lanes->direction[1][k], lanes->direction[2][k]);
}
ALWAYS_INLINE Packet load_packet(const float vectors[3][PACKET]) {
  const Packet p = {vload16(0, vectors[0]), vload16(0, vectors[1]), vload16(0, vectors[2])};
  return p;
}
ALWAYS_INLINE void store_packet(const Packet p, float vectors[3][PACKET]) {
  vstore16(p.x, 0, vectors[0]);
  vstore16(p.y, 0, vectors[1]);
  vstore16(p.z, 0, vectors[2]);
}

// each ray alone in one mesh, whose frame they are in
OUT_OF_LINE void closest_of_each_in_mesh(const Trees trees, const Packet* o, const Packet* d, const int first,
                                         const uint instance, PacketHit* hits) {
  Lanes lanes;
  store_packet(*o, lanes.origin);
  store_packet(*d, lanes.direction);
  store_hits(*hits, &lanes);
  for (uint k = 0; k < PACKET; ++k) {
    const float3 origin = lane_origin(&lanes, k), direction = lane_direction(&lanes, k);
    const BoxRay box = make_box_ray(origin, direction);
    const LeafRay leaf = make_leaf_ray(origin, direction);
    const float4 found = closest_in_mesh(trees, &box, &leaf, first, lanes.t[k]);
    if (!(found.x < lanes.t[k])) continue;
    lanes.t[k] = found.x;
    lanes.u[k] = found.y;
    lanes.v[k] = found.z;
    lanes.triangle[k] = as_uint(found.w);
    lanes.instance[k] = instance;
  }
  *hits = load_hits(&lanes);
}

ALWAYS_INLINE void closest_of_packet_in_instance(const Trees trees, const uint i, const Packet* origin,
                                                 const Packet* direction, const BoxPacket* world, PacketHit* hits) {
  global const Instance* instance = trees.instances + i;
  const bool is_moved = !(instance->flags & INSTANCE_UNMOVED);
  const Packet o = is_moved ? affine_points(instance->to_object, *origin) : *origin;
  const Packet d = is_moved ? affine_vectors(instance->to_object, *direction) : *direction;
  const int first = first_visit(trees.nodes, (int)instance->root);
  BoxPacket box = *world;
  LeafPacket leaf;
  bool is_together = make_leaf_packet(o, d, &leaf);
  if (is_together && is_moved && first >= 0) is_together = make_box_packet(o, d, &box);
  if (is_together)
    closest_of_packet_in_mesh(trees, &box, &leaf, first, i, hits);
  else
    closest_of_each_in_mesh(trees, &o, &d, first, i, hits);
}

// is it worth that they go together?
static inline bool is_coherent(const Packet d) {
  const float3 spread = (float3)(greatest_of(d.x) - least_of(d.x), greatest_of(d.y) - least_of(d.y),
                                 greatest_of(d.z) - least_of(d.z));
  const float largest = max(fabs(d.x.s0), max(fabs(d.y.s0), fabs(d.z.s0)));
  return max(spread.x, max(spread.y, spread.z)) <= PACKET_SPREAD * largest;
}

// closest hits of the scene; hits->t on entry is the largest allowed. false: the rays are no packet, nothing was done
ALWAYS_INLINE bool closest_of_packet(const Trees trees, const Packet* origin, const Packet* direction,
                                     PacketHit* hits) {
  BoxPacket world;
  if (!make_box_packet(*origin, *direction, &world) || !is_coherent(*direction)) return false;
  Visit stack[BVH_STACK];
  int size = 0, current = first_visit(trees.top, 0);
  float t_max = greatest_of(hits->t);
  do {
    while (current >= 0) {
      global const float8* node = trees.top + (size_t)current * 8;
      float8 entry;
      const uint met = packet_node_hits(node, world, t_max, &entry);
      if (!order_children(node, met, entry, stack, &size, &current)) break;
    }
    if (current >= 0) continue;
    closest_of_packet_in_instance(trees, (uint)(~current), origin, direction, &world, hits);
    t_max = greatest_of(hits->t);
  } while (next_visit(stack, t_max, &size, &current));
  return true;
}

// closest hits of rays at any distance
OUT_OF_LINE void find_closest_of_lanes(const Trees trees, Lanes* lanes) {
  PacketHit hits = {INFINITY, 0.0f, 0.0f, NO_TRIANGLE, 0};
  const Packet origin = load_packet(lanes->origin), direction = load_packet(lanes->direction);
  if (closest_of_packet(trees, &origin, &direction, &hits)) return store_hits(hits, lanes);
  for (uint k = 0; k < PACKET; ++k) {
    Hit hit = {INFINITY, 0, 0, NO_TRIANGLE, 0};
    closest_hit(trees, lane_origin(lanes, k), lane_direction(lanes, k), &hit);
    lanes->t[k] = hit.t;
    lanes->u[k] = hit.u;
    lanes->v[k] = hit.v;
    lanes->triangle[k] = hit.triangle;
    lanes->instance[k] = hit.instance;
  }
}
#endif
