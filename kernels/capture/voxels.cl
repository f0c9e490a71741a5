// Noise of a depth, and where a sample of the sparse grid lies in memory.
#ifndef PVG_CAPTURE_VOXELS_CL
#define PVG_CAPTURE_VOXELS_CL
#include "capture/voxels.h"

static inline float depth_noise(const VoxelGrid* grid, const float z) {
  return grid->noise[0] + grid->noise[1] * (z - grid->noise[2]) * (z - grid->noise[2]);
}

// index of a sample given in block coordinates that may run one over; NO_BLOCK: not kept
static inline uint sample_index(const VoxelGrid grid, global const uint* restrict block_of, const uint place,
                                const uint block, const uint3 v) {
  if (v.x < BLOCK_SIDE && v.y < BLOCK_SIDE && v.z < BLOCK_SIDE)
    return block * BLOCK_VOXELS + (v.z * BLOCK_SIDE + v.y) * BLOCK_SIDE + v.x;
  const uint3 b = (uint3)(place % grid.blocks[0], place / grid.blocks[0] % grid.blocks[1],
                          place / (grid.blocks[0] * grid.blocks[1])) + v / BLOCK_SIDE;
  if (b.x >= grid.blocks[0] || b.y >= grid.blocks[1] || b.z >= grid.blocks[2]) return NO_BLOCK;
  const uint other = block_of[(b.z * grid.blocks[1] + b.y) * grid.blocks[0] + b.x];
  const uint3 w = v % BLOCK_SIDE;
  return other == NO_BLOCK ? NO_BLOCK : other * BLOCK_VOXELS + (w.z * BLOCK_SIDE + w.y) * BLOCK_SIDE + w.x;
}

#endif
