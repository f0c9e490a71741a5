// Sixteen rays that go any way against one box at a time. The arithmetic is that of node_hits in traverse.cl: a ray that
// meets no box here would meet none there either.
#ifndef PVG_RENDER_LANES_BOX_CL
#define PVG_RENDER_LANES_BOX_CL
#include "render/lanes/leaf.cl"

// what a box's test takes, as BoxRay; back: is the direction negative
typedef struct {
  Packet near_scale, near_shift, far_scale, far_shift;
  int16 back_x, back_y, back_z;
} BoxLanes;

ALWAYS_INLINE void set_axis_of_lanes(const float16 origin, const float16 direction, float16* near_scale,
                                     float16* near_shift, float16* far_scale, float16* far_shift, int16* back) {
  const float16 inverse = inverse_of(direction), shift = -origin * inverse, slack = SHIFT_SLACK * fabs(shift);
  *near_scale = (1.0f - T_SLACK) * inverse;
  *near_shift = (1.0f - T_SLACK) * shift - slack;
  *far_scale = (1.0f + T_SLACK) * inverse;
  *far_shift = (1.0f + T_SLACK) * shift + slack;
  *back = inverse < 0.0f;
}

ALWAYS_INLINE void make_box_lanes(const Packet origin, const Packet direction, BoxLanes* r) {
  set_axis_of_lanes(origin.x, direction.x, &r->near_scale.x, &r->near_shift.x, &r->far_scale.x, &r->far_shift.x,
                    &r->back_x);
  set_axis_of_lanes(origin.y, direction.y, &r->near_scale.y, &r->near_shift.y, &r->far_scale.y, &r->far_shift.y,
                    &r->back_y);
  set_axis_of_lanes(origin.z, direction.z, &r->near_scale.z, &r->near_shift.z, &r->far_scale.z, &r->far_shift.z,
                    &r->back_z);
}

// the k-th of the rays
ALWAYS_INLINE BoxRay box_ray_of(BoxLanes* r, const uint k) {
  const BoxRay ray = {
      (float3)(ELEMENT(r->near_scale.x, k), ELEMENT(r->near_scale.y, k), ELEMENT(r->near_scale.z, k)),
      (float3)(ELEMENT(r->near_shift.x, k), ELEMENT(r->near_shift.y, k), ELEMENT(r->near_shift.z, k)),
      (float3)(ELEMENT(r->far_scale.x, k), ELEMENT(r->far_scale.y, k), ELEMENT(r->far_scale.z, k)),
      (float3)(ELEMENT(r->far_shift.x, k), ELEMENT(r->far_shift.y, k), ELEMENT(r->far_shift.z, k)),
      ELEMENT_BITS(r->back_x, k) & 32u, (ELEMENT_BITS(r->back_y, k) & 32u) + 64u,
      (ELEMENT_BITS(r->back_z, k) & 32u) + 128u};
  return ray;
}
// another one in its place
ALWAYS_INLINE void set_box_ray(BoxLanes* r, const uint k, const BoxRay ray) {
#define SET_AXIS(axis)                                   \
  ELEMENT(r->near_scale.axis, k) = ray.near_scale.axis; \
  ELEMENT(r->near_shift.axis, k) = ray.near_shift.axis; \
  ELEMENT(r->far_scale.axis, k) = ray.far_scale.axis;   \
  ELEMENT(r->far_shift.axis, k) = ray.far_shift.axis;
  SET_AXIS(x)
  SET_AXIS(y)
  SET_AXIS(z)
#undef SET_AXIS
  ELEMENT_BITS(r->back_x, k) = ray.near_scale.x < 0 ? ~0u : 0u;
  ELEMENT_BITS(r->back_y, k) = ray.near_scale.y < 0 ? ~0u : 0u;
  ELEMENT_BITS(r->back_z, k) = ray.near_scale.z < 0 ? ~0u : 0u;
}

// is box k of a node met within (0, t_max); entry: t where
ALWAYS_INLINE int16 lanes_in_box(global const float* node, const uint k, const BoxLanes* r, const float16 t_max,
                                 float16* entry) {
  const float16 lo_x = node[k], hi_x = node[8 + k], lo_y = node[16 + k], hi_y = node[24 + k], lo_z = node[32 + k],
                hi_z = node[40 + k];
  const float16 nx = (r->back_x ? hi_x : lo_x) * r->near_scale.x + r->near_shift.x;
  const float16 ny = (r->back_y ? hi_y : lo_y) * r->near_scale.y + r->near_shift.y;
  const float16 nz = (r->back_z ? hi_z : lo_z) * r->near_scale.z + r->near_shift.z;
  const float16 fx = (r->back_x ? lo_x : hi_x) * r->far_scale.x + r->far_shift.x;
  const float16 fy = (r->back_y ? lo_y : hi_y) * r->far_scale.y + r->far_shift.y;
  const float16 fz = (r->back_z ? lo_z : hi_z) * r->far_scale.z + r->far_shift.z;
  const float16 n = nx > ny ? nx : ny, m = nz > 0.0f ? nz : 0.0f, t0 = n > m ? n : m;
  const float16 f = fx < fy ? fx : fy, g = fz < t_max ? fz : t_max, t1 = f < g ? f : g;
  *entry = t0;
  return t0 <= t1;
}

#define LANES_OPEN 8  // lanes that must meet the box of a mesh; 5 and 12 take as long

// Are the boxes of the root's children tested by all lanes at once? Where the mesh has the world's frame, and enough
// lanes (bits of meet) meet the box of the whole. first: as first_visit() gives it
static inline bool opens(global const Instance* instance, const int first, const uint meet) {
  return first >= 0 && instance->flags & INSTANCE_UNMOVED && popcount(meet) >= LANES_OPEN;
}

// bits of the lanes that ask for instances with MASK_SURFACES and with MASK_RECEIVERS, and of those that clear glass does
// not stop
typedef struct {
  uint surfaces, receivers, through_glass;
} Asked;

// bits of the lanes that the instance may stop
static inline uint asked_of(const Asked asked, global const Instance* instance) {
  return (instance->mask & MASK_SURFACES ? asked.surfaces : 0u) |
         (instance->mask & MASK_RECEIVERS ? asked.receivers : 0u);
}

// one ray in what an instance's mesh has below first, as in any_hit
ALWAYS_INLINE bool any_in_instance(const Trees trees, global const Instance* instance, const int first,
                                   const float3 origin, const float3 direction) {
  const bool is_moved = !(instance->flags & INSTANCE_UNMOVED);
  const float3 o = is_moved ? affine_point(instance->to_object, origin) : origin;
  const float3 d = is_moved ? affine_vector(instance->to_object, direction) : direction;
  const LeafRay leaf = make_leaf_ray(o, d);
  if (first < 0) return block_any(trees.blocks + (size_t)(~first) * 10, leaf, BEFORE_LIGHT) != 0;
  const BoxRay box = make_box_ray(o, d);
  return any_in_mesh(trees, &box, &leaf, first, BEFORE_LIGHT);
}

// Bits of the lanes that are stopped below first, of those in meet. A leaf of a mesh in the world's frame is tested for all
// at once
OUT_OF_LINE uint stopped_of(const Trees trees, global const Instance* instance, const int first, const Lanes* lanes,
                            const LeafLanes* leaf, uint meet) {
  if (first < 0 && instance->flags & INSTANCE_UNMOVED)
    return meet & lanes_stopped_in_block(trees.blocks + (size_t)(~first) * 10, leaf, BEFORE_LIGHT);
  uint stopped = 0;
  for (; meet; meet &= meet - 1) {
    const uint lane = lowest_bit(meet);
    if (any_in_instance(trees, instance, first, lane_origin(lanes, lane), lane_direction(lanes, lane)))
      stopped |= 1u << lane;
  }
  return stopped;
}

// the same in an instance whose mesh has the world's frame: all are asked for the boxes of the root's children
ALWAYS_INLINE uint stopped_in_children(const Trees trees, global const Instance* instance, const Lanes* lanes,
                                       const LeafLanes* leaf, const BoxLanes* r, const uint meet) {
  global const float* node = (global const float*)(trees.nodes + (size_t)instance->root * 8);
  global const int* children = (global const int*)(node + 48);
  uint stopped = 0;
  for (uint k = 0; k < BVH_WIDTH; ++k) {
    if (children[k] == BVH_EMPTY) continue;
    float16 entry;
    const uint meet_child = meet & ~stopped & mask16(lanes_in_box(node, k, r, (float16)(BEFORE_LIGHT), &entry));
    if (meet_child) stopped |= stopped_of(trees, instance, children[k], lanes, leaf, meet_child);
  }
  return stopped;
}

// Bits of the lanes that an opaque instance stops within (0, BEFORE_LIGHT), no lane twice. crosses: bits of those that
// meet the box of clear glass which they may pass
OUT_OF_LINE uint lanes_stopped(const Trees trees, const Lanes* lanes, const Asked asked, uint* crosses) {
  const Packet origin = load_packet(lanes->origin), direction = load_packet(lanes->direction);
  BoxLanes r;
  make_box_lanes(origin, direction, &r);
  LeafLanes leaf;
  make_leaf_lanes(origin, direction, &leaf);
  int stack[BVH_STACK];
  int size = 0, current = 0;
  const uint all = asked.surfaces | asked.receivers;
  uint stopped = 0;
  *crosses = 0;
  for (;;) {
    global const float* node = (global const float*)(trees.top + (size_t)current * 8);
    global const int* children = (global const int*)(node + 48);
    for (uint k = 0; k < BVH_WIDTH; ++k) {
      const int child = children[k];
      if (child == BVH_EMPTY) continue;
      const uint wanted = (child < 0 ? asked_of(asked, trees.instances + (~child)) : all) & ~stopped;
      if (wanted == 0) continue;
      float16 entry;
      uint meet = wanted & mask16(lanes_in_box(node, k, &r, (float16)(BEFORE_LIGHT), &entry));
      if (meet == 0) continue;
      if (child >= 0) {
        stack[size++] = child;
        continue;
      }
      global const Instance* instance = trees.instances + (~child);
      if (instance->flags & INSTANCE_CLEAR) {
        *crosses |= meet & asked.through_glass;
        meet &= ~asked.through_glass;
      }
      if (meet == 0) continue;
      const int first = first_visit(trees.nodes, (int)instance->root);
      if (opens(instance, first, meet))
        stopped |= stopped_in_children(trees, instance, lanes, &leaf, &r, meet);
      else
        stopped |= stopped_of(trees, instance, first, lanes, &leaf, meet);
    }
    if (size == 0 || stopped == all) return stopped;
    current = stack[--size];
  }
}
#endif
