// The bounding volume hierarchy as it lies in memory: nodes of eight boxes, by component, so that one float8 operation
// tests all eight; leaves of four triangles, likewise for float4. Nodes stand level by level, parents first.
#ifndef PVG_RENDER_BVH_H
#define PVG_RENDER_BVH_H
#include "shared/types.h"

#define BVH_WIDTH 8
#define BVH_EMPTY 0x7fffffff  // child of an unused slot; its box is inside out and is never hit
#define BVH_STACK 96          // entries of the traversal's stack; the host refuses a tree that needs more

// time of a node's and of a leaf's test, measured on a CPU
#define BVH_NODE_COST 1.0f
#define BVH_LEAF_COST 2.0f

SHARED_BEGIN
typedef struct {
  f32 lo_x[BVH_WIDTH];
  f32 hi_x[BVH_WIDTH];
  f32 lo_y[BVH_WIDTH];
  f32 hi_y[BVH_WIDTH];
  f32 lo_z[BVH_WIDTH];
  f32 hi_z[BVH_WIDTH];
  i32 child[BVH_WIDTH];  // >= 0: a node, or BVH_EMPTY; < 0: leaf ~child, a block of triangles or an instance
  i32 unused[BVH_WIDTH];
} BvhNode;
SHARED_SIZE(BvhNode, 256);

// four triangles: three corners, each x y z by four; unused ones are points and never hit
typedef struct {
  f32 corner[3][3][4];  // [corner][axis][triangle, m]
  u32 triangle[4];      // index into the triangles of all meshes
} TriangleBlock;
SHARED_SIZE(TriangleBlock, 160);
SHARED_END
#endif
