// Which two primitives are a candidate of contact, and what a candidate becomes. Of two whose boxes meet, what is in them is
// measured halfway: farther apart than both can still move, it is no candidate.
// Parts of one body that lie close together at rest do not push each other there: such a pair is activated at half the
// gap that it has in the rest shape, however coarse or fine the mesh, and its offset is at most half its distance.
#include "contact/distance.cl"
#include "contact/mesh.h"
#include "energies/contact/barrier.h"
#include "shared/real.h"

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
