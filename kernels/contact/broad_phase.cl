// Broad phase: which point-triangle and edge-edge pairs may come within activation distance while the sites move
// straight from x0 to x1. Boxes of the swept primitives, grown by half the activation distance and the body's offset,
// are refitted bottom up; each query walks its tree from left to right, so the order of the pairs is fixed. Of two
// boxes that meet, contact/candidate_pair.cl asks what is in them.
#include "contact/box.cl"
#include "contact/candidate_pair.cl"
#include "contact/mesh.h"
#include "contact/tree.h"
#include "energies/contact/barrier.h"
#include "shared/look_ahead.cl"
#include "shared/mask.cl"
#include "shared/real.h"

#define LEAVES_AHEAD 16u

static inline Box box_of_point(const uint i, global const CollisionPoint* restrict points,
                               global const real* restrict x0, global const real* restrict x1) {
  return box_of_site(points[i].site, x0, x1, empty_box());
}

static inline Box box_of_edge(const uint i, global const CollisionEdge* restrict edges, global const real* restrict x0,
                              global const real* restrict x1) {
  return box_of_site(edges[i].site[1], x0, x1, box_of_site(edges[i].site[0], x0, x1, empty_box()));
}

static inline Box box_of_triangle(const uint i, global const CollisionTriangle* restrict triangles,
                                  global const real* restrict x0, global const real* restrict x1) {
  Box box = empty_box();
  for (int k = 0; k < 3; ++k) box = box_of_site(triangles[i].site[k], x0, x1, box);
  return box;
}

static inline void store_box(const Box box, global TreeNode* node) {
  vstore3(box.low, 0, node->low);
  vstore3(-box.high, 0, node->minus_high);
}

static inline global TreeNode* leaf_of(const uint i, const uint log2_leaves, global TreeNode* nodes) {
  const uint n_leaves = 1u << log2_leaves;
  return nodes + (size_t)(i >> log2_leaves) * 2 * n_leaves + n_leaves + (i & (n_leaves - 1));
}

// n: the larger of n_leaves_of_all = n_trees 2^log2_leaves and n_sites, whose positions x1 are copied to reference
// near: [n_bodies x 8] where each has partners, as of contact/near_bodies.cl: what lies outside is left out of the tree
kernel void refit_leaves(const uint n, const uint n_leaves_of_all, const uint n_sites, const uint log2_leaves,
                         global TreeNode* restrict nodes,
                         global const CollisionEdge* restrict edges, global const CollisionTriangle* restrict triangles,
                         global const CollisionBodyRow* restrict bodies, global const CollisionWorld* restrict worlds,
                         global const float* restrict near, const real margin, global const real* restrict x0,
                         global const real* restrict x1, global real* restrict reference) {
  const uint i = get_global_id(0);
  if (i < n_sites) vstore3(vload3(i, x1), i, reference);
  if (i >= n_leaves_of_all) return;
  const uint tree = i >> log2_leaves, next = min(i + LEAVES_AHEAD, n_leaves_of_all - 1);
  const uint next_primitive = leaf_of(next, log2_leaves, nodes)->primitive;
  if (next_primitive != NOTHING) {
    if (next >> log2_leaves & 1u)
      look_ahead(edges + next_primitive);
    else
      look_ahead(triangles + next_primitive);
  }
  global TreeNode* node = leaf_of(i, log2_leaves, nodes);
  const uint primitive = node->primitive;
  if (primitive == NOTHING) {
    store_box(empty_box(), node);
    return;
  }
  const bool is_edge = tree & 1u;
  const uint body = is_edge ? edges[primitive].body : triangles[primitive].body;
  if (!is_edge && bodies[body].is_half_space) {
    const Box everything = {(float3)(-INFINITY), (float3)(INFINITY)};
    store_box(everything, node);
    return;
  }
  const Box own = is_edge ? box_of_edge(primitive, edges, x0, x1) : box_of_triangle(primitive, triangles, x0, x1);
  const Box box = grow(own, 0.5 * (worlds[tree >> 1].activation_distance + margin) + bodies[body].offset);
  const float8 limit = (float8)(box.high, -box.low, INFINITY, INFINITY);
  store_box(mask8(vload8(body, near) > limit) ? empty_box() : box, node);
}

static inline void refit_node(global TreeNode* tree, const uint k) {
  global const TreeNode *a = tree + 2 * k, *b = tree + 2 * k + 1;
  vstore3(fmin(vload3(0, a->low), vload3(0, b->low)), 0, tree[k].low);
  vstore3(fmin(vload3(0, a->minus_high), vload3(0, b->minus_high)), 0, tree[k].minus_high);
}

// The nodes of up to 7 levels: of one level, which has 2^log2_nodes nodes in each tree, and of those above it. A work-group
// takes 64 nodes of that level, counted through all trees, and what lies above them. n: nodes of that level in all trees
kernel __attribute__((reqd_work_group_size(64, 1, 1))) void refit_levels(const uint n, const uint log2_nodes,
                                                                         const uint log2_leaves, global TreeNode* nodes) {
  const uint group = get_group_id(0), item = get_local_id(0);
  for (uint up = 0; up <= min(6u, log2_nodes); ++up) {
    const uint log2_now = log2_nodes - up, width = 64u >> up, i = group * width + item;
    if (item < width && i < (n >> up))
      refit_node(nodes + ((size_t)(i >> log2_now) * 2 << log2_leaves), (1u << log2_now) + (i & ((1u << log2_now) - 1)));
    barrier(CLK_GLOBAL_MEM_FENCE);
  }
}

// one comparison of the whole node with (high, -low); its last two words are no numbers and never exceed infinity
static inline bool overlaps(const float8 limit, global const TreeNode* node) {
  return !mask8(vload8(0, (global const float*)node) > limit);
}

// the same of eight nodes that follow each other, without branches: bit i is node i
static inline uint overlaps_of_eight(const float8 limit, global const TreeNode* first) {
  uint bits = 0;
  for (uint i = 0; i < 8; ++i) bits |= (uint)overlaps(limit, first + i) << i;
  return bits;
}

// is all that is below a node of one body that the query's own never touches?
static inline bool never_touches(const Search* search, global const TreeNode* node) {
  return node->body != MANY_BODIES && search->may_touch[node->body] < 0;
}

// of a query's box: high, -low, infinity twice
static inline float8 limit_of(const Query query, global const CollisionPoint* restrict points,
                              global const CollisionEdge* restrict edges,
                              global const CollisionBodyRow* restrict bodies,
                              global const CollisionWorld* restrict worlds, const real margin,
                              global const real* restrict x0, global const real* restrict x1) {
  const uint i = query.primitive & ~IS_EDGE;
  const Box own = query.primitive & IS_EDGE ? box_of_edge(i, edges, x0, x1) : box_of_point(i, points, x0, x1);
  const Box box = grow(own, 0.5 * (worlds[query.world].activation_distance + margin) + bodies[query.body].offset);
  return (float8)(box.high, -box.low, INFINITY, INFINITY);
}

static inline Search make_search(const Query query, const float8 limit, const uint q,
                                 global const CollisionPoint* restrict points,
                                 global const CollisionEdge* restrict edges,
                                 global const CollisionBodyRow* restrict bodies,
                                 global const CollisionWorld* restrict worlds,
                                 global const real* restrict pair_friction, global const u32* restrict disabled_first,
                                 const real margin) {
  Search search;
  search.is_edge = (query.primitive & IS_EDGE) != 0;
  search.primitive = query.primitive & ~IS_EDGE;
  search.slot = query.slot;
  const uint i = search.primitive;
  const uint body = query.body;
  const CollisionWorld world = worlds[query.world];
  search.site[0] = search.is_edge ? edges[i].site[0] : points[i].site;
  search.site[1] = search.is_edge ? edges[i].site[1] : points[i].site;
  search.limit = limit;
  search.body = body;
  search.activation_distance = world.activation_distance;
  search.margin = margin;
  search.offset = bodies[body].offset;
  search.may_touch = pair_friction + world.first_pair + bodies[body].index * world.n_bodies;
  search.disabled = disabled_first[q];
  search.n_disabled = disabled_first[q + 1] - disabled_first[q];
  return search;
}

// Walks to the next partner, from the left. The place of the walk is a stack of runs of up to eight nodes, of which
// those whose bit is set are still to be visited.
typedef struct {
  uint first[42], bits[42];  // 31 from the way to an edge's leaf, 11 from there down
  int n;
} Walk;

static inline void push(Walk* walk, const uint first, const uint bits) {
  if (bits == 0) return;
  walk->first[walk->n] = first;
  walk->bits[walk->n++] = bits;
}

// The nodes three levels below k, or fewer so that three remain to each of the next; those between are not asked.
static inline void push_below(Walk* walk, const Search* search, global const TreeNode* tree, const uint log2_leaves,
                              const uint k) {
  const uint levels = log2_leaves + clz(k) - 31u;
  if (levels % 3 == 0)
    push(walk, k << 3, overlaps_of_eight(search->limit, tree + (k << 3)));
  else
    push(walk, k << 1, (uint)overlaps(search->limit, tree + (k << 1)) |
                           ((uint)overlaps(search->limit, tree + (k << 1) + 1) << 1));
}

static inline uint next_partner(const Search* search, Walk* walk, global const TreeNode* tree, const uint log2_leaves,
                                global const CollisionEdge* restrict edges,
                                global const CollisionTriangle* restrict triangles,
                                global const CollisionBodyRow* restrict bodies, global const real* restrict rest,
                                global const u32* restrict disabled, global const real* restrict x0,
                                global const real* restrict x1) {
  const uint n_leaves = 1u << log2_leaves;
  // every turn takes one node off for good, and no node is put on twice
  while (walk->n > 0) {
    const int top = walk->n - 1;
    const uint bits = walk->bits[top], k = walk->first[top] + lowest_bit(bits), left = bits & (bits - 1);
    walk->bits[top] = left;
    if (left == 0) walk->n = top;
    if (never_touches(search, tree + k)) continue;
    if (k < n_leaves)
      push_below(walk, search, tree, log2_leaves, k);
    else if (may_pair(search, tree[k].primitive, edges, triangles, bodies, rest, disabled, x0, x1))
      return tree[k].primitive;
  }
  return NOTHING;
}

// A point begins at the root. An edge pair is found once, by the edge that comes first: an edge begins with what lies to
// the right of the way from the root to its own leaf.
static inline void begin_walk(Walk* walk, const Search* search, global const TreeNode* tree, const uint log2_leaves) {
  walk->n = 0;
  if (!search->is_edge) {
    push(walk, 1, overlaps(search->limit, tree + 1));
    return;
  }
  const uint leaf = (1u << log2_leaves) + search->slot;
  for (uint below = log2_leaves; below > 0 && !never_touches(search, tree + (leaf >> below)); --below) {
    const uint k = leaf >> (below - 1);
    if ((k & 1u) == 0) push(walk, k + 1, overlaps(search->limit, tree + k + 1));
  }
}

// n: queries;  near: [n_bodies x 8] where each has partners, as of contact/near_bodies.cl;  counts: [n];
// kept: [n x N_KEPT] the first partners
kernel void count_pairs(const uint n, const uint log2_leaves, global const Query* restrict queries,
                        global const TreeNode* restrict nodes, global const CollisionPoint* restrict points,
                        global const CollisionEdge* restrict edges, global const CollisionTriangle* restrict triangles,
                        global const CollisionBodyRow* restrict bodies, global const CollisionWorld* restrict worlds,
                        global const real* restrict rest, global const real* restrict pair_friction,
                        global const u32* restrict disabled_first, global const u32* restrict disabled,
                        global const float* restrict near, const real margin, global const real* restrict x0,
                        global const real* restrict x1, global u32* restrict counts, global u32* restrict kept) {
  const uint q = get_global_id(0);
  if (q >= n) return;
  const Query query = queries[q];
  const float8 limit = limit_of(query, points, edges, bodies, worlds, margin, x0, x1);
  if (mask8(vload8(query.body, near) > limit)) {
    counts[q] = 0;
    return;
  }
  const Search search = make_search(query, limit, q, points, edges, bodies, worlds, pair_friction, disabled_first, margin);
  global const TreeNode* tree = nodes + ((size_t)(2 * query.world + search.is_edge) * 2 << log2_leaves);
  Walk walk;
  begin_walk(&walk, &search, tree, log2_leaves);
  uint count = 0, other;
  while ((other = next_partner(&search, &walk, tree, log2_leaves, edges, triangles, bodies, rest, disabled, x0, x1)) !=
         NOTHING) {
    if (count < N_KEPT) kept[q * N_KEPT + count] = other;
    ++count;
  }
  counts[q] = count;
}

// offsets: [n + 1] where each query's rows begin;  capacity: of rows, those behind it are left out
kernel void fill_pairs(const uint n, const uint log2_leaves, global const Query* restrict queries,
                       global const TreeNode* restrict nodes, global const CollisionPoint* restrict points,
                       global const CollisionEdge* restrict edges, global const CollisionTriangle* restrict triangles,
                       global const CollisionBodyRow* restrict bodies, global const CollisionWorld* restrict worlds,
                       global const real* restrict rest, global const real* restrict pair_friction, global const real* restrict pair_adhesion,
                       global const u32* restrict disabled_first, global const u32* restrict disabled, const real margin,
                       global const real* restrict x0, global const real* restrict x1,
                       global const u32* restrict offsets,
                       global const u32* restrict kept, const uint capacity, global Barrier* restrict rows) {
  const uint q = get_global_id(0);
  if (q >= n) return;
  const uint first = offsets[q], found = offsets[q + 1] - first;
  const uint count = first < capacity ? min(found, capacity - first) : 0;
  if (count == 0) return;
  const Query query = queries[q];
  const uint is_edge = (query.primitive & IS_EDGE) != 0, primitive = query.primitive & ~IS_EDGE;
  if (found <= N_KEPT) {
    for (uint k = 0; k < count; ++k)
      rows[first + k] = barrier_row(is_edge, primitive, kept[q * N_KEPT + k], points, edges, triangles, bodies, worlds,
                                    rest, pair_friction, pair_adhesion);
    return;
  }
  const float8 limit = limit_of(query, points, edges, bodies, worlds, margin, x0, x1);
  const Search search = make_search(query, limit, q, points, edges, bodies, worlds, pair_friction, disabled_first, margin);
  global const TreeNode* tree = nodes + ((size_t)(2 * query.world + is_edge) * 2 << log2_leaves);
  Walk walk;
  begin_walk(&walk, &search, tree, log2_leaves);
  for (uint k = 0; k < count; ++k)
    rows[first + k] = barrier_row(
        is_edge, primitive, next_partner(&search, &walk, tree, log2_leaves, edges, triangles, bodies, rest, disabled, x0, x1),
        points, edges, triangles, bodies, worlds, rest, pair_friction, pair_adhesion);
}
