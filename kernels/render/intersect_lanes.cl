// Stage 2 on a CPU of rays that go any way, sixteen at a time: what intersect.cl does. All find the instances that they
// may meet together, then each visits its own, the nearest first.
#include "render/box_lanes.cl"

#define MOST_VISITS 24  // of a ray; one that has more goes alone

typedef struct {
  Visit of_lane[PACKET][MOST_VISITS];
  uint n[PACKET];
} Visits;

// what each lane meets of the top tree, in no order
TREE_FUNCTION void find_instances(const Trees trees, const Lanes* lanes, Visits* visits) {
  BoxLanes r;
  make_box_lanes(load_packet(lanes->origin), load_packet(lanes->direction), &r);
  int stack[BVH_STACK];
  int size = 0, current = 0;
  for (uint k = 0; k < PACKET; ++k) visits->n[k] = 0;
  for (;;) {
    global const float* node = (global const float*)(trees.top + (size_t)current * 8);
    global const int* children = (global const int*)(node + 48);
    for (uint k = 0; k < BVH_WIDTH; ++k) {
      const int child = children[k];
      if (child == BVH_EMPTY) continue;
      float16 entry;
      uint meet = mask16(lanes_in_box(node, k, &r, (float16)(INFINITY), &entry));
      if (meet == 0) continue;
      if (child >= 0) {
        stack[size++] = child;
        continue;
      }
      float t[PACKET];
      vstore16(entry, 0, t);
      for (; meet; meet &= meet - 1) {
        const uint lane = lowest_bit(meet), place = visits->n[lane]++;
        if (place < MOST_VISITS) visits->of_lane[lane][place] = make_visit(t[lane], child);
      }
    }
    if (size == 0) return;
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

TREE_FUNCTION void closest_of_visits(const Trees trees, const float3 origin, const float3 direction, Visit* visits,
                                     uint n, Hit* hit) {
  const BoxRay world = make_box_ray(origin, direction);
  const LeafRay world_leaf = make_leaf_ray(origin, direction);
  while (n > 0) {
    const Visit visit = take_nearest(visits, &n);
    if (as_float((uint)(visit >> 32)) >= hit->t) return;
    closest_in_instance(trees, ~(uint)visit, origin, direction, &world, &world_leaf, hit);
  }
}

// arguments as in intersect.cl;  a work-item takes PACKET places of the queue
kernel __attribute__((reqd_work_group_size(4, 1, 1))) void intersect_lanes(
    const uint n, global const uint* restrict queue, global const float8* restrict top,
    global const float8* restrict nodes, global const float4* restrict blocks,
    global const Instance* restrict instances, global const float4* restrict origin,
    global const float4* restrict direction, global float4* restrict hit, global uint* restrict hit_instance) {
  const uint first = get_global_id(0) * PACKET;
  if (first >= n) return;
  const Trees trees = {top, nodes, blocks, instances};
  Lanes lanes;
  for (uint k = 0; k < PACKET; ++k) {
    const uint slot = queue[min(first + k, n - 1)];  // the last lanes are filled up
    set_ray(&lanes, k, origin[slot].xyz, direction[slot].xyz);
  }
  Visits visits;
  find_instances(trees, &lanes, &visits);
  for (uint k = 0; k < PACKET && first + k < n; ++k) {
    Hit h = {INFINITY, 0, 0, NO_TRIANGLE, 0};
    const float3 o = lane_origin(&lanes, k), d = lane_direction(&lanes, k);
    if (visits.n[k] <= MOST_VISITS)
      closest_of_visits(trees, o, d, visits.of_lane[k], visits.n[k], &h);
    else
      closest_hit(trees, o, d, &h);
    const uint slot = queue[first + k];
    hit[slot] = (float4)(h.t, h.u, h.v, as_float(h.triangle));
    hit_instance[slot] = h.instance;
  }
}
