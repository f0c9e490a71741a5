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

static inline void find_whether_done(global CgWorld* world, const real tolerance, const uint most_iterations) {
  const bool is_done = world->rz <= tolerance * tolerance * world->first_rz;
  if (world->is_active && (is_done || !isfinite(world->rz))) {
    world->is_active = 0;
    world->has_converged = is_done;
  }
  if (world->iterations < most_iterations) world->iterations += world->is_active;
}

// n_items = 64 n_worlds;  has_partial, first, chunks, partial: of the sum of r . z, as of solve/world_reduce.cl
// is_wanted: [n_worlds] whether the world is solved
kernel ONE_GROUP_PER_WORLD void cg_begin(const uint n_items, const uint has_partial, global const uint* restrict first,
                                         global const Chunk* restrict chunks, global const real* restrict residual,
                                         global const real* restrict preconditioned, global real* partial,
                                         global const uint* restrict is_wanted, const real tolerance,
                                         const uint most_iterations, global CgWorld* restrict worlds) {
  const real rz = dot_of_world(has_partial, first, chunks, residual, preconditioned, partial);
  const uint w = get_group_id(0);
  if (get_local_id(0) > 0) return;
  global CgWorld* world = worlds + w;
  world->rz = world->first_rz = rz;
  world->rz_old = world->php = 0;
  world->is_active = is_wanted[w];
  world->iterations = 0;
  world->has_converged = 1;
  find_whether_done(world, tolerance, most_iterations);
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

// partial: of the sum of p . H p
kernel ONE_GROUP_PER_WORLD void cg_step_length(const uint n_items, const uint has_partial,
                                               global const uint* restrict first, global const Chunk* restrict chunks,
                                               global const real* restrict direction,
                                               global const real* restrict product, global real* partial,
                                               global CgWorld* restrict worlds) {
  const real php = dot_of_world(has_partial, first, chunks, direction, product, partial);
  if (get_local_id(0) == 0) worlds[get_group_id(0)].php = php;
}

// world: [n nodes]
kernel void cg_advance(const uint n, global const uint* restrict world, global const CgWorld* restrict worlds,
                       global const real* restrict direction, global const real* restrict product,
                       global real* restrict dx, global real* restrict residual) {
  const uint i = get_global_id(0);
  if (i >= n) return;
  global const CgWorld* own = worlds + world[i];
  if (!own->is_active) return;
  const real alpha = own->rz / own->php;
  vstore3(vload3(i, dx) + alpha * vload3(i, direction), i, dx);
  vstore3(vload3(i, residual) - alpha * vload3(i, product), i, residual);
}

// p = z + (rz_new / rz_old) p;  rz_old = 0 starts with p = z
kernel void cg_turn(const uint n, global const uint* restrict world, global const CgWorld* restrict worlds,
                    global const real* restrict preconditioned, global real* restrict direction) {
  const uint i = get_global_id(0);
  if (i >= n) return;
  global const CgWorld* own = worlds + world[i];
  if (!own->is_active) {
    vstore3((real3)(0), i, direction);
    return;
  }
  const real beta = own->rz_old > 0 ? own->rz / own->rz_old : 0;
  vstore3(vload3(i, preconditioned) + (beta != 0 ? beta * vload3(i, direction) : (real3)(0)), i, direction);
}
