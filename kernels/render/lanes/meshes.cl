// Rays in meshes, each at a node of its own, in turn: while the numbers of one are on their way, the processor is at the
// next ones. A step has no branch that goes either way by what is met, which no processor could foresee. The arithmetic
// is that of traverse.cl: hits have the bits that each ray finds alone; of two triangles at the same t either may be
// found.
#ifndef PVG_RENDER_LANES_MESHES_CL
#define PVG_RENDER_LANES_MESHES_CL
#include "render/lanes/visits.cl"

#define PACKETS_IN_TURN 8  // 4 take 3 % longer, 16 as long
#define RAYS_IN_TURN (PACKETS_IN_TURN * PACKET)

// What a ray is yet to visit of a mesh is a number: the bits of t where it begins, of which the last three are the
// child's number in its node. The order of the numbers is the order of the visits, as t >= 0.
#define CHILD_BITS 7

// the least number of a visit that begins at t or later
ALWAYS_INLINE int visits_from(const float t) { return (as_int(t) + CHILD_BITS) & ~CHILD_BITS; }

typedef struct {
  Hit hit;        // the nearest so far
  Hit no_hit;     // what a leaf without one writes, nobody reads it
  uint instance;  // whose mesh it is in
  int top;        // of the stacks; the ray is at child[top]
  int visit[BVH_STACK + 2 * BVH_WIDTH];
  int child[BVH_STACK + 2 * BVH_WIDTH];  // nodes and leaves; the lowest, where the mesh ends: BVH_EMPTY
} MeshRay;

// sixteen of them
typedef struct {
  Lanes lanes;
  BoxLanes box;  // in the frame of the mesh that each is in, at first the world's
  LeafLanes leaf;
  uint is_moved;  // bits of those that are in another frame than the world's
  Visits visits;
} MeshPacket;

// a larger and a smaller number for each pair of a and its permutation; larger: where the larger one goes
#define COMPARE_PAIRS(a, permutation, larger)              \
  {                                                        \
    const int8 b = a.permutation;                          \
    const int8 more = a > b ? a : b, less = a > b ? b : a; \
    a = (int8)larger ? more : less;                        \
  }

// descending, by a bitonic network (Batcher 1968, "Sorting Networks and Their Applications")
ALWAYS_INLINE int8 sorted_descending(int8 a) {
  COMPARE_PAIRS(a, s10325476, (-1, 0, -1, 0, -1, 0, -1, 0))
  COMPARE_PAIRS(a, s32107654, (-1, -1, 0, 0, -1, -1, 0, 0))
  COMPARE_PAIRS(a, s10325476, (-1, 0, -1, 0, -1, 0, -1, 0))
  COMPARE_PAIRS(a, s76543210, (-1, -1, -1, -1, 0, 0, 0, 0))
  COMPARE_PAIRS(a, s23016745, (-1, -1, 0, 0, -1, -1, 0, 0))
  COMPARE_PAIRS(a, s10325476, (-1, 0, -1, 0, -1, 0, -1, 0))
  return a;
}

// The ray begins at a node or leaf of an instance's mesh. Below it stand visits before any t, as many as step_at_leaf()
// reads
ALWAYS_INLINE void enter_mesh(MeshRay* r, const uint instance, const int first) {
  r->instance = instance;
  r->top = BVH_WIDTH;
  vstore8((int8)(-1), 0, r->visit);
  r->child[BVH_WIDTH - 1] = BVH_EMPTY;
  r->child[BVH_WIDTH] = first;
}

// from a node to the nearest child that is met, else to the visit before it; returned: where the ray is then
ALWAYS_INLINE int step_at_node(const Trees trees, const BoxRay box, MeshRay* r) {
  const int top = r->top, end = visits_from(r->hit.t);
  global const float8* node = trees.nodes + (size_t)r->child[top] * 8;
  float8 entry;
  const int8 is_met = boxes_met(node, box, r->hit.t, &entry);
  const int8 visit =
      sorted_descending(is_met ? (as_int8(entry) & ~CHILD_BITS) | (int8)(0, 1, 2, 3, 4, 5, 6, 7) : (int8)(-1));
  vstore8(visit, 0, r->visit + top);
  vstore8(elements_of(*(global const int8*)(node + 6), visit), 0, r->child + top);
  int next = top - 1 + (int)popcount(mask8(is_met));
  while (r->visit[next] >= end) --next;  // seldom: a hit lies before it
  r->top = next;
  return r->child[next];
}

// Tests the triangles of a leaf and goes to the next visit before the hit, or past eight that are not; returned: where
// the ray is then
ALWAYS_INLINE int step_at_leaf(const Trees trees, const LeafRay leaf, MeshRay* r) {
  global const float4* block = trees.blocks + (size_t)(~r->child[r->top]) * 10;
  Sheared s;
  float4 t, u, v;
  const int4 inside = shear_block(block, leaf, &s);
  const int4 is_met = triangles_met(inside, s, leaf.shear.z, r->hit.t, &t, &u, &v);
  const float4 met = is_met ? t : (float4)(INFINITY), a = met.s1032, b = met < a ? met : a, c = b.s2301;
  const float4 nearest = b < c ? b : c;
  const uint is_nearest = mask4(is_met & (t == nearest)), k = lowest_bit(is_nearest | 8u);
  float us[4], vs[4];
  vstore4(u, 0, us);
  vstore4(v, 0, vs);
  Hit* hit = is_nearest ? &r->hit : &r->no_hit;
  hit->t = nearest.x;
  hit->u = us[k];
  hit->v = vs[k];
  hit->triangle = ((global const uint*)(block + 9))[k];
  hit->instance = r->instance;
  const uint is_before = mask8(vload8(0, r->visit + r->top - BVH_WIDTH) < visits_from(r->hit.t));
  r->top -= 1 + (int)clz(is_before << 24 | 1u << 23);
  return r->child[r->top];
}

// The ray k of a packet begins the nearest of its visits; false: none is left that may find something nearer.
ALWAYS_INLINE bool begin_visit(const Trees trees, MeshPacket* p, const uint k, MeshRay* r) {
  if (p->visits.n[k] == 0) return false;
  const Visit visit = take_nearest(p->visits.of_lane[k], &p->visits.n[k]);
  if (as_float((uint)(visit >> 32)) >= r->hit.t) return false;
  const Start start = p->visits.starts[(uint)visit];
  enter_mesh(r, start.instance, start.first);
  global const Instance* instance = trees.instances + start.instance;
  const uint is_moved = instance->flags & INSTANCE_UNMOVED ? 0u : 1u;
  if (!is_moved && !(p->is_moved >> k & 1u)) return true;  // its numbers are those of the world's frame
  const float3 origin = lane_origin(&p->lanes, k), direction = lane_direction(&p->lanes, k);
  const float3 o = is_moved ? affine_point(instance->to_object, origin) : origin;
  const float3 d = is_moved ? affine_vector(instance->to_object, direction) : direction;
  set_box_ray(&p->box, k, make_box_ray(o, d));
  set_leaf_ray(&p->leaf, k, make_leaf_ray(o, d));
  p->is_moved = (p->is_moved & ~(1u << k)) | is_moved << k;
  return true;
}

// rays by their numbers among RAYS_IN_TURN: at nodes, at leaves, between two meshes. One place more, which add_ray()
// may write
typedef struct {
  ushort node[RAYS_IN_TURN + 1], leaf[RAYS_IN_TURN + 1], between[RAYS_IN_TURN + 1];
} RayLists;
typedef struct {
  uint node, leaf, between;
} RayCounts;

// to the list of where it is
ALWAYS_INLINE void add_ray(RayLists* lists, RayCounts* n, const uint ray, const int at) {
  lists->node[n->node] = lists->leaf[n->leaf] = lists->between[n->between] = (ushort)ray;
  n->node += (uint)at < (uint)BVH_EMPTY;
  n->leaf += (uint)at >> 31;
  n->between += at == BVH_EMPTY;
}

// goes_on: [PACKETS_IN_TURN] bits of the rays of each packet that have visits;  rays: [RAYS_IN_TURN]
OUT_OF_LINE void find_closest_in_meshes(const Trees trees, const uint* goes_on, MeshPacket* packets, MeshRay* rays) {
  RayLists a, b, *now = &a, *next = &b;
  RayCounts n = {0, 0, 0};
  for (uint p = 0; p < PACKETS_IN_TURN; ++p)
    for (uint bits = goes_on[p]; bits; bits &= bits - 1)
      now->between[n.between++] = (ushort)(p * PACKET + lowest_bit(bits));
  while (n.node + n.leaf + n.between > 0) {
    RayCounts m = {0, 0, 0};
    for (uint i = 0; i < n.leaf; ++i) {
      const uint ray = now->leaf[i];
      MeshPacket* p = packets + ray / PACKET;
      add_ray(next, &m, ray, step_at_leaf(trees, leaf_ray_of(&p->leaf, ray % PACKET), rays + ray));
    }
    for (uint i = 0; i < n.node; ++i) {
      const uint ray = now->node[i];
      MeshPacket* p = packets + ray / PACKET;
      add_ray(next, &m, ray, step_at_node(trees, box_ray_of(&p->box, ray % PACKET), rays + ray));
    }
    for (uint i = 0; i < n.between; ++i) {
      const uint ray = now->between[i];
      if (begin_visit(trees, packets + ray / PACKET, ray % PACKET, rays + ray))
        add_ray(next, &m, ray, rays[ray].child[BVH_WIDTH]);
    }
    n = m;
    RayLists* last = now;
    now = next;
    next = last;
  }
}
#endif
