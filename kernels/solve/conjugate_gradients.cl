// Preconditioned conjugate gradients for H dx = -g, all worlds at once (Hestenes & Stiefel 1952):
//   alpha = r.z / p.Hp,  dx += alpha p,  r -= alpha Hp,  z = M^-1 r,  beta = (r.z)_new / r.z,  p = z + beta p
// A world is done when the residual, measured in the preconditioner's norm, has fallen by the tolerance. That is found
// here, so that the host may start several iterations and look afterwards: in a world that is done they change nothing.
#include "shared/real.h"
#include "solve/cg_world.h"
#include "solve/world_sum.cl"
#define ONE_GROUP_PER_WORLD __attribute__((reqd_work_group_size(ITEMS, 1, 1)))

// dx = 0, r = -g
kernel void cg_start(const uint n, global const real* restrict gradient, global real* restrict dx,
                     global real* restrict residual) {
  const uint i = get_global_id(0);
  if (i >= n) return;
  vstore3((real3)(0), i, dx);
  vstore3(-vload3(i, gradient), i, residual);
}

// p = z + (rz_new / rz_old) p;  rz_old = 0 starts with p = z
static inline void turn_node(const uint i, global const CgWorld* own, global const real* restrict preconditioned,
                             global real* restrict direction) {
  if (!own->is_active) {
    vstore3((real3)(0), i, direction);
    return;
  }
  const real beta = own->rz_old > 0 ? own->rz / own->rz_old : 0;
  vstore3(vload3(i, preconditioned) + (beta != 0 ? beta * vload3(i, direction) : (real3)(0)), i, direction);
}

static inline void advance_node(const uint i, global const CgWorld* own, global const real* restrict direction,
                                global const real* restrict product, global real* restrict dx,
                                global real* restrict residual) {
  if (!own->is_active) return;
  const real alpha = own->rz / own->php;
  vstore3(vload3(i, dx) + alpha * vload3(i, direction), i, dx);
  vstore3(vload3(i, residual) - alpha * vload3(i, product), i, residual);
}

static inline void find_whether_done(global CgWorld* world, const real tolerance, const uint most_iterations) {
  const bool is_done = world->rz <= tolerance * tolerance * world->first_rz;
  if (world->is_active && (is_done || !isfinite(world->rz))) {
    world->is_active = 0;
    world->has_converged = is_done;
  }
  if (world->iterations < most_iterations) world->iterations += world->is_active;
}

// n_items = 64 n_worlds;  has_partial, first, chunks, partial: of the sum of r . z, as of solve/world_reduce.cl
// is_wanted: [n_worlds] whether the world is solved;  turns: then cg_turn is done for the first iteration besides
kernel ONE_GROUP_PER_WORLD void cg_begin(const uint n_items, const uint has_partial, global const uint* restrict first,
                                         global const Chunk* restrict chunks, global const real* restrict residual,
                                         global const real* restrict preconditioned, global real* partial,
                                         global const uint* restrict is_wanted, const real tolerance,
                                         const uint most_iterations, global CgWorld* worlds, const uint turns,
                                         global real* restrict direction) {
  const real rz = dot_of_world(has_partial, first, chunks, residual, preconditioned, partial);
  const uint w = get_group_id(0), item = get_local_id(0);
  global CgWorld* world = worlds + w;
  if (item == 0) {
    world->rz = world->first_rz = rz;
    world->rz_old = world->php = 0;
    world->is_active = is_wanted[w];
    world->iterations = 0;
    world->has_converged = 1;
    find_whether_done(world, tolerance, most_iterations);
  }
  barrier(CLK_GLOBAL_MEM_FENCE);
  for (uint c = turns ? first[w] + item : first[w + 1]; c < first[w + 1]; c += ITEMS)
    for (uint i = chunks[c].begin; i < chunks[c].end; ++i) turn_node(i, world, preconditioned, direction);
}

// the same after each iteration
kernel ONE_GROUP_PER_WORLD void cg_test(const uint n_items, const uint has_partial, global const uint* restrict first,
                                        global const Chunk* restrict chunks, global const real* restrict residual,
                                        global const real* restrict preconditioned, global real* partial,
                                        const real tolerance, const uint most_iterations,
                                        global CgWorld* restrict worlds) {
  const real rz = dot_of_world(has_partial, first, chunks, residual, preconditioned, partial);
  global CgWorld* world = worlds + get_group_id(0);
  if (get_local_id(0) > 0 || !world->is_active) return;
  world->rz_old = world->rz;
  world->rz = rz;
  find_whether_done(world, tolerance, most_iterations);
}

// Whether the residual r is nothing beside the first one, -g, as after one iteration with an exact factor: this takes no
// preconditioner.  partial: [2 n_chunks];  tolerance: of |r| / |g|
kernel ONE_GROUP_PER_WORLD void cg_test_residual(const uint n_items, global const uint* restrict first,
                                                 global const Chunk* restrict chunks,
                                                 global const real* restrict residual,
                                                 global const real* restrict gradient, global real* partial,
                                                 const real tolerance, global CgWorld* restrict worlds) {
  const uint w = get_group_id(0), begin = first[w], end = first[w + 1];
  for (uint c = begin + get_local_id(0); c < end; c += ITEMS) {
    partial[2 * c] = dot_of_chunk(chunks[c], residual, residual);
    partial[2 * c + 1] = dot_of_chunk(chunks[c], gradient, gradient);
  }
  barrier(CLK_GLOBAL_MEM_FENCE);
  if (get_local_id(0) > 0 || !worlds[w].is_active) return;
  real now = 0, at_first = 0;
  for (uint c = begin; c < end; ++c) now += partial[2 * c], at_first += partial[2 * c + 1];
  if (now <= tolerance * tolerance * at_first) worlds[w].is_active = 0;
}

// partial: of the sum of p . H p;  advances: then cg_advance is done besides
kernel ONE_GROUP_PER_WORLD void cg_step_length(const uint n_items, const uint has_partial,
                                               global const uint* restrict first, global const Chunk* restrict chunks,
                                               global const real* restrict direction,
                                               global const real* restrict product, global real* partial,
                                               global CgWorld* worlds, const uint advances, global real* restrict dx,
                                               global real* restrict residual) {
  const real php = dot_of_world(has_partial, first, chunks, direction, product, partial);
  const uint w = get_group_id(0), item = get_local_id(0);
  global CgWorld* world = worlds + w;
  if (item == 0) world->php = php;
  barrier(CLK_GLOBAL_MEM_FENCE);
  for (uint c = advances ? first[w] + item : first[w + 1]; c < first[w + 1]; c += ITEMS)
    for (uint i = chunks[c].begin; i < chunks[c].end; ++i) advance_node(i, world, direction, product, dx, residual);
}

// world: [n nodes]
kernel void cg_advance(const uint n, global const uint* restrict world, global const CgWorld* restrict worlds,
                       global const real* restrict direction, global const real* restrict product,
                       global real* restrict dx, global real* restrict residual) {
  const uint i = get_global_id(0);
  if (i < n) advance_node(i, worlds + world[i], direction, product, dx, residual);
}

kernel void cg_turn(const uint n, global const uint* restrict world, global const CgWorld* restrict worlds,
                    global const real* restrict preconditioned, global real* restrict direction) {
  const uint i = get_global_id(0);
  if (i < n) turn_node(i, worlds + world[i], preconditioned, direction);
}
