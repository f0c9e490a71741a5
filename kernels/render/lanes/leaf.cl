// Sixteen rays that go any way against the triangles of a leaf, one triangle at a time. The arithmetic is that of block_hits
// and block_any in traverse.cl, so hits have the same bits; of two triangles at the same t either may be found.
#ifndef PVG_RENDER_LANES_LEAF_CL
#define PVG_RENDER_LANES_LEAF_CL
#include "render/lanes/packet.cl"

// what a leaf's test takes, as LeafRay: each ray's axes are in the order of its own
typedef struct {
  Packet shift, shear;
  int16 is_x, is_z;   // is this component of the direction the largest? Else it is y
  uint16 kx, ky, kz;  // as in LeafRay
} LeafLanes;

// x, y and z in the order of each ray's axes
ALWAYS_INLINE Packet turned(const int16 is_x, const int16 is_z, const float16 x, const float16 y, const float16 z) {
  const Packet p = {is_z ? x : (is_x ? y : z), is_z ? y : (is_x ? z : x), is_z ? z : (is_x ? x : y)};
  return p;
}

ALWAYS_INLINE void make_leaf_lanes(const Packet origin, const Packet direction, LeafLanes* r) {
  find_largest_components(direction, &r->is_x, &r->is_z);
  r->shift = turned(r->is_x, r->is_z, origin.x, origin.y, origin.z);
  const Packet d = turned(r->is_x, r->is_z, direction.x, direction.y, direction.z);
  const Packet shear = {d.x / d.z, d.y / d.z, 1.0f / d.z};
  r->shear = shear;
  r->kx = as_uint16(r->is_z ? (int16)(0) : (r->is_x ? (int16)(16) : (int16)(32)));
  r->ky = as_uint16(r->is_z ? (int16)(16) : (r->is_x ? (int16)(32) : (int16)(0)));
  r->kz = as_uint16(r->is_z ? (int16)(32) : (r->is_x ? (int16)(0) : (int16)(16)));
}

// element k of a vector in memory
#define ELEMENT(v, k) (((float*)&(v))[k])
#define ELEMENT_BITS(v, k) (((uint*)&(v))[k])

// the k-th of the rays
ALWAYS_INLINE LeafRay leaf_ray_of(LeafLanes* r, const uint k) {
  const LeafRay ray = {(float3)(ELEMENT(r->shift.x, k), ELEMENT(r->shift.y, k), ELEMENT(r->shift.z, k)),
                       (float3)(ELEMENT(r->shear.x, k), ELEMENT(r->shear.y, k), ELEMENT(r->shear.z, k)),
                       ELEMENT_BITS(r->kx, k), ELEMENT_BITS(r->ky, k), ELEMENT_BITS(r->kz, k)};
  return ray;
}
// another one in its place; is_x and is_z stay, so that the lane is only good for leaf_ray_of()
ALWAYS_INLINE void set_leaf_ray(LeafLanes* r, const uint k, const LeafRay ray) {
  ELEMENT(r->shift.x, k) = ray.shift.x;
  ELEMENT(r->shift.y, k) = ray.shift.y;
  ELEMENT(r->shift.z, k) = ray.shift.z;
  ELEMENT(r->shear.x, k) = ray.shear.x;
  ELEMENT(r->shear.y, k) = ray.shear.y;
  ELEMENT(r->shear.z, k) = ray.shear.z;
  ELEMENT_BITS(r->kx, k) = ray.kx;
  ELEMENT_BITS(r->ky, k) = ray.ky;
  ELEMENT_BITS(r->kz, k) = ray.kz;
}

// A corner of a triangle, seen from the rays' origins. corner: where its x stands, y and z follow four floats apart
ALWAYS_INLINE Packet corner_from_lanes(global const float* corner, const LeafLanes* r) {
  const Packet p = turned(r->is_x, r->is_z, (float16)(corner[0]), (float16)(corner[4]), (float16)(corner[8]));
  const Packet from = {p.x - r->shift.x, p.y - r->shift.y, p.z - r->shift.z};
  return from;
}

// first: where the x of the triangle's first corner stands in the block
ALWAYS_INLINE int16 shear_triangle_of_lanes(global const float* first, const LeafLanes* r, ShearedPacket* s) {
  return shear_triangle(corner_from_lanes(first, r), corner_from_lanes(first + 12, r), corner_from_lanes(first + 24, r),
                        r->shear, s);
}

// hits: the nearest so far
ALWAYS_INLINE void closest_of_lanes_in_block(global const float4* block, const LeafLanes* r, const uint instance,
                                             PacketHit* hits) {
  global const uint* triangles = (global const uint*)(block + 9);
  for (uint k = 0; k < 4 && triangles[k] != NO_TRIANGLE; ++k) {
    ShearedPacket s;
    const int16 inside = shear_triangle_of_lanes((global const float*)block + k, r, &s);
    keep_nearer(inside, s, r->shear.z, triangles[k], instance, hits);
  }
}

// bits of the lanes that a triangle of the block stops within (0, t_max)
ALWAYS_INLINE uint lanes_stopped_in_block(global const float4* block, const LeafLanes* r, const float t_max) {
  global const uint* triangles = (global const uint*)(block + 9);
  uint stopped = 0;
  for (uint k = 0; k < 4 && triangles[k] != NO_TRIANGLE; ++k) {
    ShearedPacket s;
    const int16 inside = shear_triangle_of_lanes((global const float*)block + k, r, &s);
    const float16 det = s.area_a + s.area_b + s.area_c;
    const int16 sign = as_int16(det) & (int16)(0x80000000);
    const float16 t = as_float16(as_int16((s.area_a * s.az + s.area_b * s.bz + s.area_c * s.cz) * r->shear.z) ^ sign);
    stopped |= mask16(inside & (t > 0.0f) & (t < t_max * fabs(det)));
  }
  return stopped;
}
#endif
