// Sixteen rays that go any way in the tree over instances: together they find which meshes each may meet, and test the
// leaves of small meshes there.
#ifndef PVG_RENDER_LANES_VISITS_CL
#define PVG_RENDER_LANES_VISITS_CL
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

// Bits of the boxes of a node that some of the lanes meet within (0, t_max). All are tested before any is visited: a
// branch for each would go either way, which no processor foresees. meet: [BVH_WIDTH] bits of the lanes;  entry:
// [BVH_WIDTH] t where
ALWAYS_INLINE uint boxes_met_by_lanes(global const float* node, const BoxLanes* r, const float16 t_max, uint* meet,
                                      float16* entry) {
  global const int* children = (global const int*)(node + 48);
  uint met = 0;
  for (uint k = 0; k < BVH_WIDTH && children[k] != BVH_EMPTY; ++k) {
    meet[k] = mask16(lanes_in_box(node, k, r, t_max, entry + k));
    met |= (meet[k] != 0 ? 1u : 0u) << k;
  }
  return met;
}

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
  uint meet[BVH_WIDTH];
  float16 entry[BVH_WIDTH];
  for (uint met = boxes_met_by_lanes(node, r, hits->t, meet, entry); met; met &= met - 1) {
    const uint k = lowest_bit(met);
    add_visits(trees, v, instance, children[k], true, leaf, entry[k], meet[k], hits);
  }
}

// What each lane meets of the top tree, in no order; into lanes: the hits in leaves that are tested here. box, leaf: the
// rays as these tests take them, only where there are visits
OUT_OF_LINE void find_visits(const Trees trees, Lanes* lanes, BoxLanes* box, LeafLanes* leaf, Visits* visits) {
  const Packet origin = load_packet(lanes->origin), direction = load_packet(lanes->direction);
  BoxLanes b;
  make_box_lanes(origin, direction, &b);
  LeafLanes l;
  make_leaf_lanes(origin, direction, &l);
  PacketHit hits = {INFINITY, 0.0f, 0.0f, NO_TRIANGLE, 0};
  int stack[BVH_STACK];
  int size = 0, current = 0;
  vstore16((uint16)(0), 0, visits->n);
  visits->n_starts = 0;
  for (;;) {
    global const float* node = (global const float*)(trees.top + (size_t)current * 8);
    global const int* children = (global const int*)(node + 48);
    uint meet[BVH_WIDTH];
    float16 entry[BVH_WIDTH];
    for (uint met = boxes_met_by_lanes(node, &b, hits.t, meet, entry); met; met &= met - 1) {
      const uint k = lowest_bit(met);
      const int child = children[k];
      if (child >= 0) {
        stack[size++] = child;
        continue;
      }
      const uint i = (uint)(~child);
      global const Instance* instance = trees.instances + i;
      const int first = first_visit(trees.nodes, (int)instance->root);
      if (opens(instance, first, meet[k]))
        add_visits_of_children(trees, visits, i, &b, &l, &hits);
      else
        add_visits(trees, visits, i, first, instance->flags & INSTANCE_UNMOVED, &l, entry[k], meet[k], &hits);
    }
    if (size == 0) {
      store_hits(hits, lanes);
      if (visits->n_starts > 0) {
        *box = b;
        *leaf = l;
      }
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
#endif
