// What Newton's method decides per world, found on the device so that the host need not look before the line search; each
// with the move that follows from it, in one launch.
#include "solve/moved.cl"
#include "solve/world_largest.cl"
#include "solve/world_least.cl"

// How far each world goes along its direction: as far as all its pairs are certified; nowhere where it is not active or,
// if `settles`, where its correction is within the tolerance. And there: trial = x + step d, of nodes and of the sites
// that they carry. A work-group finds the steps of the worlds that its nodes and sites are of.
// n: the more of nodes and sites;  first: [n_worlds + 1] of the worlds' pairs;  certified: [n_pairs] in [0, 1], of_64:
// least of each 64 of them;  is_active: [n_worlds];  largest: [n_worlds] lengths of the corrections [m];  tolerance:
// [n_worlds, m/s];  h [s];  short_of: factor on a step that was cut, which would end where the barrier is steepest;
// step: [n_worlds]
kernel __attribute__((reqd_work_group_size(ITEMS, 1, 1))) void move_certified(
    const uint n, const uint n_nodes, const uint n_sites, global const uint* restrict world,
    global const Site* restrict sites, global const u32* restrict first, global const real* restrict certified,
    global const real* restrict of_64, global const u32* restrict is_active, const uint settles,
    global const real* restrict largest, global const real* restrict tolerance, const real h, const real short_of,
    global const real* restrict x, global const real* restrict direction, global real* restrict trial,
    global real* restrict trial_sites, global real* restrict step) {
  local real of_item[ITEMS], shared_step;
  local uint from, to;  // worlds
  const uint i = get_global_id(0), item = get_local_id(0);
  const uint world_of_node = i < n_nodes ? world[i] : 0, world_of_site = i < n_sites ? world[sites[i].node[0]] : 0;
  if (item == 0) {
    from = 0xffffffffu;
    to = 0;
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  if (i < n_nodes) {
    atomic_min(&from, world_of_node);
    atomic_max(&to, world_of_node);
  }
  if (i < n_sites) {
    atomic_min(&from, world_of_site);
    atomic_max(&to, world_of_site);
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  real node_step = 0, site_step = 0;
  const uint begin = from, end = to + 1;
  for (uint w = begin; w < end; ++w) {
    const real least = least_of_pairs(first[w], first[w + 1], certified, of_64, of_item);
    if (item == 0) {
      const bool stays = !is_active[w] || (settles && largest[w] / h <= tolerance[w]);
      shared_step = stays ? 0 : (least < 1 ? short_of * least : least);
    }
    barrier(CLK_LOCAL_MEM_FENCE);
    if (w == world_of_node) node_step = shared_step;
    if (w == world_of_site) site_step = shared_step;
    barrier(CLK_LOCAL_MEM_FENCE);
  }
  if (i < n_nodes) {
    vstore3(moved_node(i, node_step, x, direction), i, trial);
    if (i == 0 || world[i - 1] != world_of_node) step[world_of_node] = node_step;
  }
  if (i < n_sites) vstore3(moved_site(sites[i], site_step, x, direction), i, trial_sites);
}

// largest[w] = largest length of the direction at the world's chunks of sites, as by largest_worlds of
// solve/world_reduce.cl, and trial = x + step d as above.
// n: 64 for each world, then for each 64 nodes and sites;  chunk_first: [n_worlds + 1] of chunks
kernel __attribute__((reqd_work_group_size(ITEMS, 1, 1))) void measure_and_move(
    const uint n, const uint n_worlds, const uint n_nodes, const uint n_sites, global const uint* restrict chunk_first,
    global const Chunk* restrict chunks, global const uint* restrict world, global const Site* restrict sites,
    global const real* restrict step, global const real* restrict x, global const real* restrict direction,
    global real* restrict largest, global real* restrict trial, global real* restrict trial_sites) {
  local real of_item[ITEMS];
  const uint group = get_group_id(0), item = get_local_id(0);
  const bool is_world = group < n_worlds;
  const uint i = get_global_id(0) - (is_world ? 0 : n_worlds * ITEMS);
  const uint begin = is_world ? chunk_first[group] : 0, end = is_world ? chunk_first[group + 1] : 0;
  real own = 0;
  for (uint c = begin; c < end; ++c) own = max(own, largest_of_chunk(chunks[c], item, ITEMS, sites, direction));
  of_item[item] = own;
  barrier(CLK_LOCAL_MEM_FENCE);
  if (is_world && item == 0) {
    for (uint k = 1; k < ITEMS; ++k) own = max(own, of_item[k]);
    largest[group] = own;
  }
  if (!is_world && i < n_nodes) vstore3(moved_node(i, step[world[i]], x, direction), i, trial);
  if (!is_world && i < n_sites)
    vstore3(moved_site(sites[i], step[world[sites[i].node[0]]], x, direction), i, trial_sites);
}
