// From candidates to contacts: gaps, what is active, lagged friction rows, reports; the smallest of a number per world.
#include "contact/activity.cl"
#include "contact/list_contacts.cl"
#include "contact/mesh.h"
#include "contact/report.h"
#include "energies/contact/adhesion_law.cl"
#include "energies/contact/barrier_law.cl"
#include "energies/contact/friction.h"
#include "solve/world_least.cl"

static inline void load_sites(global const Barrier* row, global const real* restrict x, real3* xe) {
  for (int i = 0; i < 4; ++i) xe[i] = vload3(row->site[i], x);
}

// gap: [n, m], infinite where it is not below the activation distance;  is_active: [n] 1 where it exerts a force
// counts: [n / 64, rounded up] of the active ones
kernel __attribute__((reqd_work_group_size(ITEMS, 1, 1))) void pair_gaps(
    const uint n, global const Barrier* restrict pairs, global const real* restrict x, global real* restrict gap,
    global u32* restrict is_active, global u32* restrict counts) {
  local uint count;
  const uint e = get_global_id(0);
  bool exerts_force = false;
  if (e < n) {
    real3 xe[4];
    load_sites(pairs + e, x, xe);
    const real g = pair_distance(pairs[e].kind, xe).d - pairs[e].offset;
    const bool is_near = !(g >= pairs[e].activation_distance);  // so that NaN shows
    exerts_force = is_near && pairs[e].area > 0;
    gap[e] = is_near ? g : INFINITY;
    is_active[e] = exerts_force;
  }
  const uint n_active = count_active(exerts_force, &count);
  if (get_local_id(0) == 0) counts[get_group_id(0)] = n_active;
}

// where the rows of a world begin in a list that has room for `capacity`: what a query found begins at offsets[query]
static inline uint found_before(const uint world, const uint capacity, global const u32* restrict offsets,
                                global const u32* restrict first_query) {
  return capacity > 0 ? min(capacity, offsets[first_query[world]]) : 0;
}

// Candidates from three lists: by world, in it list by list. What is behind them has no force and is of no world.
// n: the capacities' sum;  found: [3 x (n_worlds + 1)] where each list's worlds begin, as far as they were found
// first: [n_worlds + 1] where they begin in `to`
kernel void merge_lists(const uint n, const uint n_worlds, const uint capacity0, global const u32* restrict offsets0,
                        global const u32* restrict first_query0, global const Barrier* restrict rows0,
                        const uint capacity1, global const u32* restrict offsets1,
                        global const u32* restrict first_query1, global const Barrier* restrict rows1,
                        const uint capacity2, global const u32* restrict offsets2,
                        global const u32* restrict first_query2, global const Barrier* restrict rows2,
                        global u32* restrict found, global u32* restrict first, global Barrier* restrict to) {
  const uint i = get_global_id(0);
  for (uint w = i; w <= n_worlds; w += get_global_size(0)) {
    found[w] = capacity0 > 0 ? offsets0[first_query0[w]] : 0;
    found[n_worlds + 1 + w] = capacity1 > 0 ? offsets1[first_query1[w]] : 0;
    found[2 * (n_worlds + 1) + w] = capacity2 > 0 ? offsets2[first_query2[w]] : 0;
    first[w] = found_before(w, capacity0, offsets0, first_query0) + found_before(w, capacity1, offsets1, first_query1) +
               found_before(w, capacity2, offsets2, first_query2);
  }
  if (i >= n) return;
  const uint list = i < capacity0 ? 0 : (i < capacity0 + capacity1 ? 1 : 2);
  const uint e = i - (list > 0 ? capacity0 : 0) - (list > 1 ? capacity1 : 0);
  const uint n0 = found_before(n_worlds, capacity0, offsets0, first_query0),
             n1 = found_before(n_worlds, capacity1, offsets1, first_query1),
             n2 = found_before(n_worlds, capacity2, offsets2, first_query2);
  const uint n_own = list == 0 ? n0 : (list == 1 ? n1 : n2);
  if (e >= n_own) {
    const uint before = (list > 0 ? capacity0 - n0 : 0) + (list > 1 ? capacity1 - n1 : 0);
    Barrier nothing = {{0, 0, 0, 0}, POINT_TRIANGLE, {0, 0}, n_worlds, 0, 0, 0, 0, 0, 0, 0, 0};
    to[n0 + n1 + n2 + before + e - n_own] = nothing;
    return;
  }
  const Barrier row = (list == 0 ? rows0 : (list == 1 ? rows1 : rows2))[e];
  const uint w = row.world, before0 = found_before(w, capacity0, offsets0, first_query0),
             before1 = found_before(w, capacity1, offsets1, first_query1),
             before2 = found_before(w, capacity2, offsets2, first_query2);
  uint place = before0 + before1 + before2 + e - (list == 0 ? before0 : (list == 1 ? before1 : before2));
  if (list > 0) place += found_before(w + 1, capacity0, offsets0, first_query0) - before0;
  if (list > 1) place += found_before(w + 1, capacity1, offsets1, first_query1) - before1;
  to[place] = row;
}

// The contacts of all pairs: see list_contacts.  n: pairs
kernel __attribute__((reqd_work_group_size(ITEMS, 1, 1))) void fill_contacts(
    const uint n, const uint n_worlds, global const Barrier* restrict pairs, global const u32* restrict is_active,
    global const u32* restrict counts, global const u32* restrict first_pair, global u32* restrict first,
    global Barrier* restrict contacts, global u32* restrict sites, const uint search, global u32* restrict changed) {
  local u32 before[ITEMS], offset[ITEMS + 1];
  const uint group = get_group_id(0), begin = group * ITEMS;
  const bool has_any = has_contacts(begin, n, pairs, counts);
  before[get_local_id(0)] = has_any ? contacts_before(group, counts) : 0;
  barrier(CLK_LOCAL_MEM_FENCE);
  if (has_any) find_offsets(begin, n, is_active, before, offset);
  barrier(CLK_LOCAL_MEM_FENCE);
  if (has_any) list_contacts(begin, n, n_worlds, pairs, first_pair, offset, first, contacts, sites, search, changed);
}

// lambda = kappa w m |b'|  [N]
static inline real normal_force(const Barrier* p, const real3* x, const real d) {
  return p->stiffness * p->area * pair_mollifier(p, x).value *
         -barrier_slope(d - p->offset, barrier_range(p->adhesion, p->activation_distance));
}

// rows: [n] of energies/contact/friction.cl, of as many as there are: n_contacts[n_worlds]
kernel void lag_friction(const uint n, const uint n_worlds, global const u32* restrict n_contacts,
                         global const Barrier* restrict contacts,
                         global const CollisionWorld* restrict worlds, global const real* restrict x,
                         global Friction* restrict rows) {
  const uint e = get_global_id(0);
  if (e >= n || e >= n_contacts[n_worlds]) return;
  const Barrier p = contacts[e];
  real3 xe[4];
  load_sites(contacts + e, x, xe);
  const Distance distance = pair_distance(p.kind, xe);
  Friction row;
  for (int i = 0; i < 4; ++i) {
    row.site[i] = p.site[i];
    row.coefficient[i] = distance.c[i];
  }
  row.kind = p.kind;
  row.body[0] = p.body[0];
  row.body[1] = p.body[1];
  row.world = p.world;
  vstore3(distance.n, 0, row.normal);
  row.normal_force = normal_force(&p, xe, distance.d);
  row.friction = p.friction;
  row.friction_velocity = worlds[p.world].friction_velocity;
  vstore3((real3)(0.0), 0, row.anchor);
  row.dissipation = 0;
  rows[e] = row;
}

// What lag_friction found, with what contacts carry over from the last step.  anchors: [n x 3, m];  sites: [n x 4] of rows
kernel void anchor_friction(const uint n, global const Friction* restrict lagged, global const real* restrict anchors,
                            global Friction* restrict rows, global u32* restrict sites) {
  const uint e = get_global_id(0);
  if (e >= n) return;
  Friction row = lagged[e];
  vstore3(vload3(e, anchors), 0, row.anchor);
  rows[e] = row;
  for (uint k = 0; k < 4; ++k) sites[4 * e + k] = row.site[k];
}

kernel void report_contacts(const uint n, global const Barrier* restrict contacts, global const real* restrict x,
                            global ContactReport* restrict reports) {
  const uint e = get_global_id(0);
  if (e >= n) return;
  const Barrier p = contacts[e];
  real3 xe[4];
  load_sites(contacts + e, x, xe);
  const Distance distance = pair_distance(p.kind, xe);
  // both closest points: the sum of |c_i| x_i counts each once
  real3 point = (real3)(0.0);
  for (int i = 0; i < 4; ++i) point += 0.5 * fabs(distance.c[i]) * xe[i];
  if (p.kind == POINT_PLANE) point = xe[0] - 0.5 * distance.d * distance.n;
  ContactReport report;
  vstore3(point, 0, report.point);
  vstore3(distance.n, 0, report.normal);
  report.gap = distance.d - p.offset;
  report.normal_force = normal_force(&p, xe, distance.d);
  if (p.adhesion > 0)
    report.normal_force -=
        p.adhesion * p.area * pair_mollifier(&p, xe).value * adhesion_slope(report.gap, p.activation_distance);
  reports[e] = report;
}

// n_items = ITEMS n_worlds;  first: [n_worlds + 1];  none: where there are no values;  least: [n_worlds]
kernel __attribute__((reqd_work_group_size(ITEMS, 1, 1))) void min_of_worlds(
    const uint n_items, global const u32* restrict first, global const real* restrict values, const real none,
    global real* restrict least) {
  local real of_item[ITEMS];
  const real own = least_of_world(first, values, none, of_item);
  if (get_local_id(0) == 0) least[get_group_id(0)] = own;
}
