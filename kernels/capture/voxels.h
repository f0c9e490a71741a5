// What the kernels of capture share with the host: a grid of voxels of which only blocks near surfaces are kept.
#ifndef PVG_CAPTURE_VOXELS_H
#define PVG_CAPTURE_VOXELS_H
#include "shared/types.h"

#define BLOCK_SIDE 8u      // voxels along a block's edge
#define BLOCK_VOXELS 512u  // of one block, x fastest
#define NO_BLOCK 0xffffffffu
#define TILE_SIDE 4u  // pixels of a picture of depth that are looked at together, to each side
#define REGISTRATION_SUMS 30u    // 21 of J^T J, 6 of J^T r, r^2, weight, pixels: registration.cl
#define REGISTRATION_PIXELS 32u  // of a work-item

SHARED_BEGIN
// Samples of the signed distance stand at origin + index * voxel.
typedef struct {
  f32 origin[3];  // of sample (0, 0, 0) [m]
  f32 voxel;      // distance of two samples [m]
  u32 blocks[3];  // of the whole grid, kept or not
  f32 truncation;  // distances beyond are cut, at least [m]
  f32 noise[3];    // standard deviation of a depth z: noise[0] + noise[1] (z - noise[2])^2  [m, 1/m, m]
  f32 max_depth;   // larger depths are left out [m]
} VoxelGrid;
SHARED_SIZE(VoxelGrid, 48);
SHARED_END
#endif
