// A deformed mesh in its old tree: first the triangles of the leaves, then the boxes of the nodes, level by level from
// the deepest up. The shape of the tree stays.
#include "render/bvh.h"
#include "render/path.h"

// blocks first .. first + n - 1
kernel void refit_blocks(const uint n, const uint first, global const uint* restrict triangles,
                         global const Vertex* restrict vertices, global TriangleBlock* restrict blocks) {
  const uint i = get_global_id(0);
  if (i >= n) return;
  global TriangleBlock* block = blocks + first + i;
  for (int k = 0; k < 4; ++k) {
    const uint triangle = block->triangle[k];
    if (triangle == NO_TRIANGLE) continue;
    const uint3 corner = vload3(triangle, triangles);
    for (int axis = 0; axis < 3; ++axis) {
      block->corner[0][axis][k] = vertices[corner.x].point[axis];
      block->corner[1][axis][k] = vertices[corner.y].point[axis];
      block->corner[2][axis][k] = vertices[corner.z].point[axis];
    }
  }
}

static inline void block_box(global const TriangleBlock* block, float* lo, float* hi) {
  for (int c = 0; c < 3; ++c) {
    lo[c] = INFINITY;
    hi[c] = -INFINITY;
    for (int k = 0; k < 4; ++k) {
      if (block->triangle[k] == NO_TRIANGLE) continue;
      const float p = block->corner[0][c][k], q = block->corner[1][c][k], r = block->corner[2][c][k];
      lo[c] = min(lo[c], min(p, min(q, r)));
      hi[c] = max(hi[c], max(p, max(q, r)));
    }
  }
}

// empty slots are inside out and change nothing
static inline void node_box(global const BvhNode* node, float* lo, float* hi) {
  for (int c = 0; c < 3; ++c) {
    lo[c] = INFINITY;
    hi[c] = -INFINITY;
  }
  for (int k = 0; k < BVH_WIDTH; ++k) {
    if (node->child[k] == BVH_EMPTY) continue;
    lo[0] = min(lo[0], node->lo_x[k]);
    hi[0] = max(hi[0], node->hi_x[k]);
    lo[1] = min(lo[1], node->lo_y[k]);
    hi[1] = max(hi[1], node->hi_y[k]);
    lo[2] = min(lo[2], node->lo_z[k]);
    hi[2] = max(hi[2], node->hi_z[k]);
  }
}

// nodes first .. first + n - 1 of one level
kernel void refit_nodes(const uint n, const uint first, global const TriangleBlock* restrict blocks,
                        global BvhNode* nodes) {
  const uint i = get_global_id(0);
  if (i >= n) return;
  global BvhNode* node = nodes + first + i;
  for (int k = 0; k < BVH_WIDTH; ++k) {
    const int child = node->child[k];
    if (child == BVH_EMPTY) continue;
    float lo[3], hi[3];
    if (child < 0)
      block_box(blocks + (~child), lo, hi);
    else
      node_box(nodes + child, lo, hi);
    node->lo_x[k] = lo[0];
    node->hi_x[k] = hi[0];
    node->lo_y[k] = lo[1];
    node->hi_y[k] = hi[1];
    node->lo_z[k] = lo[2];
    node->hi_z[k] = hi[2];
  }
}

// What rays pay for the children of each node, by the surface area heuristic  [n, m^2]
kernel void node_costs(const uint n, const uint first, global const BvhNode* restrict nodes,
                       global float* restrict costs) {
  const uint i = get_global_id(0);
  if (i >= n) return;
  global const BvhNode* node = nodes + first + i;
  float sum = 0;
  for (int k = 0; k < BVH_WIDTH; ++k) {
    const int child = node->child[k];
    if (child == BVH_EMPTY) continue;
    const float x = node->hi_x[k] - node->lo_x[k], y = node->hi_y[k] - node->lo_y[k], z = node->hi_z[k] - node->lo_z[k];
    sum += (child < 0 ? BVH_LEAF_COST : BVH_NODE_COST) * (x * y + y * z + z * x);
  }
  costs[i] = sum;
}
