// Preconditioned conjugate gradients for H dx = -g, all worlds at once (Hestenes & Stiefel 1952):
//   alpha = r.z / p.Hp,  dx += alpha p,  r -= alpha Hp,  z = M^-1 r,  beta = (r.z)_new / r.z,  p = z + beta p
// A world is done when the residual, measured in the preconditioner's norm, has fallen by the tolerance. That is found
// here, so that the host may start several iterations and look afterwards: in a world that is done they change nothing.
//
// A work-group has a chunk of at most 64 nodes of one world. r.z and p.Hp are left as sums over chunks by who finds z and
// Hp; whoever needs them sums over the world's chunks itself, so that no launch is spent on that. All work-groups of a
// world find the same bits. Hence what a world knows of itself is read in one buffer and written to another.
// In all kernels: first: [n_worlds + 1] chunks of the worlds;  chunks, partial: [n_chunks]
#include "solve/cg_world.h"
#include "solve/group_sum.cl"
#include "solve/product_of_four.cl"
#include "solve/site.h"
#include "solve/value_at_site.cl"
#define CHUNK_PER_GROUP __attribute__((reqd_work_group_size(ITEMS, 1, 1)))
// what is known of a world before the direction turns: as it is, at the start of a solve, after an iteration
#define AS_IT_IS 0u
#define AT_START 1u
#define AFTER_ITERATION 2u

// dx = 0, r = -g
kernel void cg_start(const uint n, global const real* restrict gradient, global real* restrict dx,
                     global real* restrict residual) {
  const uint i = get_global_id(0);
  if (i >= n) return;
  vstore3((real3)(0), i, dx);
  vstore3(-vload3(i, gradient), i, residual);
}

// partial[c] = sum of a . b over the chunk;  a, b: [n_nodes x 3]
kernel CHUNK_PER_GROUP void cg_dot(const uint n_items, global const Chunk* restrict chunks, global const real* restrict a,
                                   global const real* restrict b, global real* restrict partial) {
  local real of_item[ITEMS + EIGHTS];
  const Chunk chunk = chunks[get_group_id(0)];
  const uint i = chunk.begin + get_local_id(0);
  const real sum = sum_of_group(i < chunk.end ? dot(vload3(i, a), vload3(i, b)) : 0, of_item);
  if (get_local_id(0) == 0) partial[get_group_id(0)] = sum;
}

// of partial over the world's chunks, for the first work-item
static inline real sum_of_world(const uint world, global const uint* restrict first, global const real* restrict partial,
                                local real* of_item) {
  real own = 0;
  for (uint c = first[world] + get_local_id(0); c < first[world + 1]; c += ITEMS) own += partial[c];
  return sum_of_group(own, of_item);
}

// The same of a . b where no launch left it in partial, which small worlds save: the bits of cg_dot, for the work-items
// add up what those of the chunks would, eight nodes each.
static inline real dot_of_world(const uint world, global const uint* restrict first, global const Chunk* restrict chunks,
                                global const real* restrict a, global const real* restrict b, local real* of_item) {
  const uint item = get_local_id(0), begin = first[world], end = first[world + 1];
  real own = 0;
  for (uint done = 0; done < end - begin; done += EIGHTS) {
    const uint c = begin + done + item / EIGHTS, width = ITEMS / EIGHTS;
    real sum = 0;
    if (c < end) {
      const uint from = chunks[c].begin + item % EIGHTS * width;
      for (uint i = from; i < from + width; ++i) sum += i < chunks[c].end ? dot(vload3(i, a), vload3(i, b)) : 0;
    }
    of_item[item] = sum;
    barrier(CLK_LOCAL_MEM_FENCE);
    const uint mine = item - done % ITEMS;  // chunk of these, if it is less than EIGHTS
    if (mine < EIGHTS) {
      real of_chunk = 0;
      for (uint k = 0; k < EIGHTS; ++k) of_chunk += of_item[mine * EIGHTS + k];
      own += of_chunk;
    }
    barrier(CLK_LOCAL_MEM_FENCE);
  }
  return sum_of_group(own, of_item);
}

static inline void find_whether_done(CgWorld* world, const real tolerance, const uint most_iterations) {
  const bool is_done = world->rz <= tolerance * tolerance * world->first_rz;
  if (world->is_active && (is_done || !isfinite(world->rz))) {
    world->is_active = 0;
    world->has_converged = is_done;
  }
  if (world->iterations < most_iterations) world->iterations += world->is_active;
}

// What a world knows of itself once its r.z is new
static inline CgWorld renewed(const CgWorld before, const uint when, const real rz, const uint is_wanted,
                              const real tolerance, const uint most_iterations) {
  CgWorld world = before;
  if (when == AT_START) {
    world.rz = world.first_rz = rz;
    world.rz_old = 0;
    world.is_active = is_wanted;
    world.iterations = 0;
    world.has_converged = 1;
  } else if (when == AS_IT_IS || !world.is_active) {
    return world;
  } else {
    world.rz_old = world.rz;
    world.rz = rz;
  }
  find_whether_done(&world, tolerance, most_iterations);
  return world;
}

// of |r|^2 over that of tolerance |g|, of a world's chunks, for the first work-item
static inline real residual_excess(const uint begin, const uint end, global const Chunk* restrict chunks,
                                   global const real* restrict residual, global const real* restrict gradient,
                                   const real tolerance, local real* of_item) {
  real now = 0, at_first = 0;
  for (uint c = begin; c < end; ++c)
    for (uint i = chunks[c].begin + get_local_id(0); i < chunks[c].end; i += ITEMS) {
      now += dot(vload3(i, residual), vload3(i, residual));
      at_first += dot(vload3(i, gradient), vload3(i, gradient));
    }
  return sum_of_group(now - tolerance * tolerance * at_first, of_item);
}

// is_wanted: [n_worlds] whether the world is solved;  worlds: [n_worlds]
// looks: whether to find what cg_test_residual would have found, by gradient and residual_tolerance
// has_partial: whether partial is r . z;  residual, preconditioned: r and z, where it is not
kernel CHUNK_PER_GROUP void cg_test(const uint n_items, const uint when, global const uint* restrict first,
                                    global const Chunk* restrict chunks, const uint has_partial,
                                    global const real* restrict partial, global const real* restrict residual,
                                    global const real* restrict preconditioned, global const uint* restrict is_wanted,
                                    const real tolerance, const uint most_iterations, const uint looks,
                                    global const real* restrict gradient, const real residual_tolerance,
                                    global const CgWorld* restrict before, global CgWorld* restrict worlds) {
  local real of_item[ITEMS + EIGHTS];
  const uint w = get_group_id(0), end = first[w + 1];
  const real excess = residual_excess(looks ? first[w] : end, end, chunks, residual, gradient, residual_tolerance, of_item);
  barrier(CLK_LOCAL_MEM_FENCE);
  const real rz = has_partial ? sum_of_world(w, first, partial, of_item)
                              : dot_of_world(w, first, chunks, residual, preconditioned, of_item);
  if (get_local_id(0) > 0) return;
  CgWorld world = renewed(before[w], when, rz, is_wanted[w], tolerance, most_iterations);
  if (looks) world.residual_tells = !is_wanted[w] || excess <= 0;
  worlds[w] = world;
}

// p = z + beta p of a node; 0 in a world that is not active
static inline real3 turned_node(const uint i, const bool is_active, const real beta, global const real* restrict z,
                                global const real* restrict p) {
  if (!is_active) return (real3)(0);
  return vload3(i, z) + (beta != 0 ? beta * vload3(i, p) : (real3)(0));
}

static inline real3 turned_site(global const Site* restrict site, const bool is_active, const real beta,
                                global const real* restrict z, global const real* restrict p) {
  const Site s = *site;
  real3 sum = s.weight[0] * turned_node(s.node[0], is_active, beta, z, p);
  for (int k = 1; k < 4; ++k)
    if (s.weight[k] != 0) sum += s.weight[k] * turned_node(s.node[k], is_active, beta, z, p);
  return sum;
}

// The new direction, and H times it for elements that are not assembled: of four sites, of two kinds.
// n_items: 64 for each chunk, then for each 64 elements of the first kind, then of the second
// has_partial, residual: as of cg_test;  direction: [n_nodes x 3];  node_world: [n_nodes];  element_sites: [(n_first + n_second) x 4], ascending by world in each
// kind;  first_blocks, second_blocks: [12 x 12] of each element;  rows: from row first_row on, four of each element
kernel CHUNK_PER_GROUP void cg_turn(const uint n_items, const uint n_chunks, const uint when,
                                    global const uint* restrict first, global const Chunk* restrict chunks,
                                    const uint has_partial, global const real* restrict partial,
                                    global const uint* restrict is_wanted,
                                    const real tolerance, const uint most_iterations,
                                    global const CgWorld* restrict before, global CgWorld* restrict worlds,
                                    global const real* restrict residual, global const real* restrict preconditioned,
                                    global const real* restrict direction_before, global real* restrict direction,
                                    const uint n_first, const uint n_second, global const uint* restrict node_world,
                                    global const uint* restrict element_sites, global const Site* restrict sites,
                                    global const real* restrict first_blocks, global const real* restrict second_blocks,
                                    const uint first_row, global real* restrict rows) {
  local real of_item[ITEMS + EIGHTS], shared_beta;
  local uint shared_is_active;
  const uint group = get_group_id(0), item = get_local_id(0), n_first_groups = (n_first + ITEMS - 1) / ITEMS;
  const bool has_nodes = group < n_chunks;
  const Chunk chunk = chunks[has_nodes ? group : 0];
  const bool is_second = !has_nodes && group - n_chunks >= n_first_groups;
  // of its kind: this work-group's first element, and the kind's end
  const uint begin = (group - n_chunks - (is_second ? n_first_groups : 0)) * ITEMS, end = is_second ? n_second : n_first;
  const uint kind_first = is_second ? n_first : 0, e = kind_first + begin + item;
  const bool has_element = !has_nodes && begin + item < end;
  uint own_world = chunk.world, first_world = own_world, last_world = own_world;
  if (!has_nodes) {
    own_world = has_element ? node_world[sites[element_sites[4 * e]].node[0]] : 0;
    first_world = node_world[sites[element_sites[4 * (kind_first + begin)]].node[0]];
    last_world = node_world[sites[element_sites[4 * (kind_first + min(end, begin + ITEMS) - 1)]].node[0]];
  }
  real beta = 0;
  bool is_active = false;
  for (uint w = first_world; w <= last_world; ++w) {
    const real rz = has_partial ? sum_of_world(w, first, partial, of_item)
                                : dot_of_world(w, first, chunks, residual, preconditioned, of_item);
    if (item == 0) {
      const CgWorld world = renewed(before[w], when, rz, is_wanted[w], tolerance, most_iterations);
      if (has_nodes && group == first[w]) worlds[w] = world;
      shared_beta = world.rz_old > 0 ? world.rz / world.rz_old : 0;
      shared_is_active = world.is_active;
    }
    barrier(CLK_LOCAL_MEM_FENCE);
    if (w == own_world) {
      beta = shared_beta;
      is_active = shared_is_active;
    }
    barrier(CLK_LOCAL_MEM_FENCE);
  }
  const uint i = chunk.begin + item;
  if (has_nodes && i < chunk.end)
    vstore3(turned_node(i, is_active, beta, preconditioned, direction_before), i, direction);
  if (!has_element) return;
  real d[12];
  for (int s = 0; s < 4; ++s)
    vstore3(turned_site(sites + element_sites[4 * e + s], is_active, beta, preconditioned, direction_before), s, d);
  product_of_four((is_second ? second_blocks : first_blocks) + (size_t)(begin + item) * 144, d,
                  rows + (size_t)(first_row + e * 4) * 3);
}

// partial: of the sum of p . H p
kernel CHUNK_PER_GROUP void cg_advance(const uint n_items, global const uint* restrict first,
                                       global const Chunk* restrict chunks, global const real* restrict partial,
                                       global const CgWorld* restrict worlds, global const real* restrict direction,
                                       global const real* restrict product, global real* restrict dx,
                                       global real* restrict residual) {
  local real of_item[ITEMS + EIGHTS], shared_alpha;
  const Chunk chunk = chunks[get_group_id(0)];
  const real php = sum_of_world(chunk.world, first, partial, of_item);
  if (get_local_id(0) == 0) shared_alpha = worlds[chunk.world].rz / php;
  barrier(CLK_LOCAL_MEM_FENCE);
  const uint i = chunk.begin + get_local_id(0);
  if (i >= chunk.end || !worlds[chunk.world].is_active) return;
  const real alpha = shared_alpha;
  vstore3(vload3(i, dx) + alpha * vload3(i, direction), i, dx);
  vstore3(vload3(i, residual) - alpha * vload3(i, product), i, residual);
}

// Whether the residual r is nothing beside the first one, -g, as after one iteration with an exact factor: this takes no
// preconditioner.  n_items: 64 for each world;  tolerance: of |r| / |g|
kernel CHUNK_PER_GROUP void cg_test_residual(const uint n_items, global const uint* restrict first,
                                             global const Chunk* restrict chunks, global const real* restrict residual,
                                             global const real* restrict gradient, const real tolerance,
                                             global CgWorld* restrict worlds) {
  local real of_item[ITEMS + EIGHTS];
  const uint w = get_group_id(0);
  const real excess = residual_excess(first[w], first[w + 1], chunks, residual, gradient, tolerance, of_item);
  if (get_local_id(0) == 0 && worlds[w].is_active && excess <= 0) worlds[w].is_active = 0;
}
