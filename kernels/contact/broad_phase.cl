// Broad phase: which point-triangle and edge-edge pairs may come within activation distance while the sites move
// straight from x0 to x1. Boxes of the swept primitives, grown by half the activation distance and the body's offset,
// are refitted bottom up; each query walks its tree from left to right, so the order of the pairs is fixed. Of two
// boxes that meet, what is in them is measured halfway: farther apart than both can still move, it is no candidate.
// Parts of one body that lie close together at rest do not push each other there: such a pair is activated at half the
// gap that it has in the rest shape, however coarse or fine the mesh, and its offset is at most half its distance.
#include "contact/box.cl"
#include "contact/distance.cl"
#include "contact/mesh.h"
#include "contact/tree.h"
#include "energies/contact/barrier.h"
#include "shared/mask.cl"
#include "shared/real.h"

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
  const uint tree = i >> log2_leaves, n_leaves = 1u << log2_leaves;
  global TreeNode* node = nodes + (size_t)tree * 2 * n_leaves + n_leaves + (i & (n_leaves - 1));
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

// Everything that decides about one query.
typedef struct {
  float8 limit;  // of its box: high, -low, infinity twice
  uint primitive, is_edge, slot;
  uint site[2];                  // of the point (twice) or of the edge
  real activation_distance;      // of its world [m]
  real offset;                   // of its body [m]
  real margin;                   // how much farther is looked [m]
  uint disabled, n_disabled;     // its run in `disabled`
  uint body;
  global const real* may_touch;  // its body's row of the table of pairs
} Search;

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

// a pair that shares a site or that was recorded as never touching
static inline bool is_excluded(const Search* search, global const u32* site, const uint other,
                               global const u32* restrict disabled) {
  const uint n_corners = search->is_edge ? 2 : 3;
  for (uint k = 0; k < n_corners; ++k)
    if (site[k] == search->site[0] || site[k] == search->site[1]) return true;
  for (uint k = 0; k < search->n_disabled; ++k)
    if (disabled[search->disabled + k] == other) return true;
  return false;
}

// a point against a triangle of this body
static inline uint kind_of_triangle(global const CollisionBodyRow* body) {
  return body->is_half_space ? POINT_PLANE : POINT_TRIANGLE;
}

// Two primitives halfway, and how far the sites of each can still come towards the other: by half their way, less what
// all four sites do together.
typedef struct {
  real3 x[4];  // [m]
  real motion;  // of both [m]
} HalfWay;

static inline HalfWay half_way_of(const uint* site, const uint n_first, global const real* restrict x0,
                                  global const real* restrict x1) {
  HalfWay half_way;
  real3 motion[4], mean = (real3)(0.0);
  for (uint i = 0; i < 4; ++i) {
    const real3 a = vload3(site[i], x0), b = vload3(site[i], x1);
    half_way.x[i] = 0.5 * (a + b);
    motion[i] = 0.5 * (b - a);
    mean += 0.25 * motion[i];
  }
  real first = 0, second = 0;  // squared
  for (uint i = 0; i < 4; ++i) {
    const real3 own = motion[i] - mean;
    if (i < n_first)
      first = fmax(first, dot(own, own));
    else
      second = fmax(second, dot(own, own));
  }
  half_way.motion = sqrt(first) + sqrt(second);
  return half_way;
}

// How far from each other two primitives act.
typedef struct {
  real activation_distance, offset;  // [m]
} Reach;

// of two primitives of one body that are so far apart in its rest shape [m]; grows with that
static inline Reach reach_of(const real distance, const real activation_distance, const real offset) {
  Reach reach;
  reach.offset = fmin(offset, 0.5 * distance);
  reach.activation_distance = fmin(activation_distance, 0.5 * (distance - reach.offset));
  return reach;
}

// site: of the pair, rest: of all sites in their bodies' rest shapes [n_sites x 3, m], NaN where there is none
static inline Reach reach_at_rest(const uint is_edge, const uint* site, const real activation_distance,
                                  const real offset, global const real* restrict rest) {
  real3 x[4];
  for (int i = 0; i < 4; ++i) x[i] = vload3(site[i], rest);
  return reach_of(pair_distance(is_edge, x).d, activation_distance, offset);
}

static inline bool may_pair(const Search* search, const uint other, global const CollisionEdge* restrict edges,
                            global const CollisionTriangle* restrict triangles,
                            global const CollisionBodyRow* restrict bodies, global const real* restrict rest,
                            global const u32* restrict disabled, global const real* restrict x0,
                            global const real* restrict x1) {
  global const u32* site = search->is_edge ? edges[other].site : triangles[other].site;
  const uint body = search->is_edge ? edges[other].body : triangles[other].body;
  if (is_excluded(search, site, other, disabled)) return false;
  const uint n_first = search->is_edge ? 2 : 1;
  const uint pair[4] = {search->site[0], search->is_edge ? search->site[1] : site[0],
                        search->is_edge ? site[0] : site[1], search->is_edge ? site[1] : site[2]};
  const HalfWay half_way = half_way_of(pair, n_first, x0, x1);
  const uint kind = search->is_edge ? EDGE_EDGE : kind_of_triangle(bodies + body);
  const real offset = search->offset + bodies[body].offset;
  // the last factor covers rounding
  const real further = search->margin + half_way.motion,
             widest = (search->activation_distance + offset + further) * 1.000001;
  if (is_beyond(kind, half_way.x, widest)) return false;
  const Distance now = pair_distance(kind, half_way.x);
  // written so that NaN stays
  if (now.d > widest) return false;
  if (body != search->body) return true;
  // At rest they are no farther apart than what are their closest points now.
  real3 apart = (real3)(0.0);
  for (int i = 0; i < 4; ++i) apart += now.c[i] * vload3(pair[i], rest);
  const Reach most = reach_of(length(apart), search->activation_distance, offset);
  if (now.d > (most.activation_distance + most.offset + further) * 1.000001) return false;
  const Reach reach = reach_at_rest(search->is_edge, pair, search->activation_distance, offset, rest);
  return !(now.d > (reach.activation_distance + reach.offset + further) * 1.000001);
}

// What a found pair becomes.
static inline Barrier barrier_row(const uint is_edge, const uint first, const uint second,
                                  global const CollisionPoint* restrict points,
                                  global const CollisionEdge* restrict edges,
                                  global const CollisionTriangle* restrict triangles,
                                  global const CollisionBodyRow* restrict bodies,
                                  global const CollisionWorld* restrict worlds, global const real* restrict rest,
                                  global const real* restrict pair_friction,
                                  global const real* restrict pair_adhesion) {
  Barrier row;
  if (is_edge) {
    const CollisionEdge a = edges[first], b = edges[second];
    row.site[0] = a.site[0], row.site[1] = a.site[1], row.site[2] = b.site[0], row.site[3] = b.site[1];
    row.body[0] = a.body, row.body[1] = b.body;
    row.area = a.is_flat || b.is_flat ? 0 : fmin(a.area, b.area);
    row.mollifier_threshold = 1e-3 * a.rest_length * a.rest_length * b.rest_length * b.rest_length;
  } else {
    const CollisionPoint a = points[first];
    const CollisionTriangle b = triangles[second];
    row.site[0] = a.site, row.site[1] = b.site[0], row.site[2] = b.site[1], row.site[3] = b.site[2];
    row.body[0] = a.body, row.body[1] = b.body;
    row.area = a.area;
    row.mollifier_threshold = 0;
  }
  const CollisionBodyRow a = bodies[row.body[0]], b = bodies[row.body[1]];
  const CollisionWorld world = worlds[a.world];
  row.kind = is_edge ? EDGE_EDGE : kind_of_triangle(bodies + row.body[1]);
  row.world = a.world;
  row.stiffness = world.stiffness;
  row.activation_distance = world.activation_distance;
  row.offset = a.offset + b.offset;
  if (row.body[0] == row.body[1]) {
    const Reach reach = reach_at_rest(is_edge, row.site, row.activation_distance, row.offset, rest);
    row.activation_distance = reach.activation_distance;
    row.offset = reach.offset;
  }
  const uint of_pair = world.first_pair + a.index * world.n_bodies + b.index;
  row.friction = pair_friction[of_pair];
  row.adhesion = pair_adhesion[of_pair];
  row.unused = 0;
  return row;
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
