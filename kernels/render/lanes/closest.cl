// Closest hits of sixteen rays that go any way, with the bits that each would find alone; of two triangles at the same t
// either may be found. Together they walk the tree over instances and test the leaves of small meshes there; then each ray
// visits what else it may meet, the nearest first.
#ifndef PVG_RENDER_LANES_CLOSEST_CL
#define PVG_RENDER_LANES_CLOSEST_CL
#include "render/lanes/box.cl"

#define MOST_VISITS 24   // of a ray; one that has more goes alone
#define MOST_STARTS 128  // of a packet; where it has more each of its rays goes alone

// where a visit of a mesh begins
typedef struct {
  uint instance;
  int first;  // a node or a leaf of its mesh
} Start;

typedef struct {
  Visit of_lane[PACKET][MOST_VISITS];  // each: t where it begins, number of its start
  uint n[PACKET];                      // visits of each lane
  Start starts[MOST_STARTS];
  uint n_starts;
} Visits;

// The lanes in meet (bits) meet the box of what an instance's mesh has below first, at t = entry. The triangles of a leaf in
// the world's frame are tested for all lanes at once; anything else is a visit for later.
static inline void add_visits(const Trees trees, Visits* v, const uint instance, const int first, const bool is_unmoved,
                              const LeafLanes* leaf, const float16 entry, uint meet, PacketHit* hits) {
  if (first < 0 && is_unmoved) {
    closest_of_lanes_in_block(trees.blocks + (size_t)(~first) * 10, leaf, instance, hits);
    return;
  }
  const uint start = v->n_starts++;  // counts on beyond what there is room for, as n does: these rays go alone
  if (start >= MOST_STARTS) return;
  v->starts[start].instance = instance;
  v->starts[start].first = first;
  float t[PACKET];
  vstore16(entry, 0, t);
  for (; meet; meet &= meet - 1) {
    const uint lane = lowest_bit(meet), place = v->n[lane]++;
    if (place < MOST_VISITS) v->of_lane[lane][place] = make_visit(t[lane], (int)start);
  }
}

// the same of the children of an instance's root, whose mesh has the world's frame
static inline void add_visits_of_children(const Trees trees, Visits* v, const uint instance, const BoxLanes* r,
                                          const LeafLanes* leaf, PacketHit* hits) {
  global const float* node = (global const float*)(trees.nodes + (size_t)trees.instances[instance].root * 8);
  global const int* children = (global const int*)(node + 48);
  for (uint k = 0; k < BVH_WIDTH; ++k) {
    if (children[k] == BVH_EMPTY) continue;
    float16 entry;
    const uint meet = mask16(lanes_in_box(node, k, r, hits->t, &entry));
    if (meet) add_visits(trees, v, instance, children[k], true, leaf, entry, meet, hits);
  }
}

// what each lane meets of the top tree, in no order; into lanes: the hits in leaves that are tested here
OUT_OF_LINE void find_visits(const Trees trees, Lanes* lanes, Visits* visits) {
  const Packet origin = load_packet(lanes->origin), direction = load_packet(lanes->direction);
  BoxLanes r;
  make_box_lanes(origin, direction, &r);
  LeafLanes leaf;
  make_leaf_lanes(origin, direction, &leaf);
  PacketHit hits = {INFINITY, 0.0f, 0.0f, NO_TRIANGLE, 0};
  int stack[BVH_STACK];
  int size = 0, current = 0;
  vstore16((uint16)(0), 0, visits->n);
  visits->n_starts = 0;
  for (;;) {
    global const float* node = (global const float*)(trees.top + (size_t)current * 8);
    global const int* children = (global const int*)(node + 48);
    for (uint k = 0; k < BVH_WIDTH; ++k) {
      const int child = children[k];
      if (child == BVH_EMPTY) continue;
      float16 entry;
      const uint meet = mask16(lanes_in_box(node, k, &r, hits.t, &entry));
      if (meet == 0) continue;
      if (child >= 0) {
        stack[size++] = child;
        continue;
      }
      const uint i = (uint)(~child);
      global const Instance* instance = trees.instances + i;
      const int first = first_visit(trees.nodes, (int)instance->root);
      if (opens(instance, first, meet))
        add_visits_of_children(trees, visits, i, &r, &leaf, &hits);
      else
        add_visits(trees, visits, i, first, instance->flags & INSTANCE_UNMOVED, &leaf, entry, meet, &hits);
    }
    if (size == 0) {
      store_hits(hits, lanes);
      return;
    }
    current = stack[--size];
  }
}

// the nearest of n visits, which is taken away
static inline Visit take_nearest(Visit* visits, uint* n) {
  uint nearest = 0;
  for (uint k = 1; k < *n; ++k) nearest = visits[k] < visits[nearest] ? k : nearest;
  const Visit taken = visits[nearest];
  visits[nearest] = visits[--(*n)];
  return taken;
}

// t, u, v, triangle in one vector, as in closest_in_mesh; found, *instance: the nearest so far
OUT_OF_LINE float4 closest_of_visits(const Trees trees, const float3 origin, const float3 direction,
                                       const Start* starts, Visit* visits, uint n, const float4 found, uint* instance) {
  Hit hit = {found.x, found.y, found.z, as_uint(found.w), *instance};
  const BoxRay world = make_box_ray(origin, direction);
  const LeafRay world_leaf = make_leaf_ray(origin, direction);
  while (n > 0) {
    const Visit visit = take_nearest(visits, &n);
    if (as_float((uint)(visit >> 32)) >= hit.t) break;
    const Start start = starts[(uint)visit];
    closest_in_instance(trees, start.instance, start.first, origin, direction, &world, &world_leaf, &hit);
  }
  *instance = hit.instance;
  return (float4)(hit.t, hit.u, hit.v, as_float(hit.triangle));
}

// the same in the whole scene
OUT_OF_LINE float4 closest_alone(const Trees trees, const float3 origin, const float3 direction, uint* instance) {
  Hit hit = {INFINITY, 0, 0, NO_TRIANGLE, 0};
  closest_hit(trees, origin, direction, &hit);
  *instance = hit.instance;
  return (float4)(hit.t, hit.u, hit.v, as_float(hit.triangle));
}

// n rays of a queue
OUT_OF_LINE void find_closest_of_queue(const Trees trees, const uint n, global const uint* queue,
                                         global const float4* origin, global const float4* direction,
                                         global float4* hit, global uint* hit_instance) {
  Lanes lanes;
  Visits visits;
  for (uint first = 0; first < n; first += PACKET) {
    for (uint k = 0; k < PACKET; ++k) {
      const uint slot = queue[min(first + k, n - 1)];  // the last lanes are filled up
      set_ray(&lanes, k, origin[slot].xyz, direction[slot].xyz);
    }
    find_visits(trees, &lanes, &visits);
    for (uint k = 0; k < PACKET && first + k < n; ++k) {
      float4 found = (float4)(lanes.t[k], lanes.u[k], lanes.v[k], as_float(lanes.triangle[k]));
      uint instance = lanes.instance[k];
      if (visits.n_starts > MOST_STARTS || visits.n[k] > MOST_VISITS)
        found = closest_alone(trees, lane_origin(&lanes, k), lane_direction(&lanes, k), &instance);
      else if (visits.n[k] > 0)
        found = closest_of_visits(trees, lane_origin(&lanes, k), lane_direction(&lanes, k), visits.starts,
                                  visits.of_lane[k], visits.n[k], found, &instance);
      const uint slot = queue[first + k];
      hit[slot] = found;
      hit_instance[slot] = instance;
    }
  }
}

// n rays that start in neighbouring pixels, in the slots from first on
OUT_OF_LINE void find_closest_of_neighbours(const Trees trees, const uint first, const uint n,
                                              global const float4* origin, global const float4* direction,
                                              global float4* hit, global uint* hit_instance) {
  Lanes lanes;
  for (uint i = first; i < first + n; i += PACKET) {
    for (uint k = 0; k < PACKET; ++k) {
      const uint slot = min(i + k, first + n - 1);
      set_ray(&lanes, k, origin[slot].xyz, direction[slot].xyz);
    }
    find_closest_of_lanes(trees, &lanes);
    for (uint k = 0; k < PACKET && i + k < first + n; ++k) {
      hit[i + k] = (float4)(lanes.t[k], lanes.u[k], lanes.v[k], as_float(lanes.triangle[k]));
      hit_instance[i + k] = lanes.instance[k];
    }
  }
}
#endif
