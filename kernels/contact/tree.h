// Bounding volumes: one complete binary tree per world and kind of primitive, all of 2^log2_leaves leaves, laid one
// after the other. Tree 2 w holds the triangles of world w, tree 2 w + 1 its edges. Node 1 is the root, 2 k and 2 k + 1
// are the children of k, leaf slot s is node 2^log2_leaves + s; node 0 is unused.
#ifndef PVG_CONTACT_TREE_H
#define PVG_CONTACT_TREE_H
#include "shared/types.h"
#define NOTHING 0xffffffffu      // no primitive in this leaf
#define MANY_BODIES 0xffffffffu  // below this node are several bodies
#define IS_EDGE 0x80000000u      // bit of a query
#define N_KEPT 8u                // hits that a query keeps from the first traversal, so that it needs no second
SHARED_BEGIN
typedef struct {
  f32 low[3], minus_high[3];  // of the box [m], rounded outward; signs such that less is larger
  u32 body;                   // index within the world of all primitives below, or MANY_BODIES
  u32 primitive;              // of a leaf: index of the triangle or edge, or NOTHING
} TreeNode;
SHARED_SIZE(TreeNode, 32);

// A point that looks among the triangles, or an edge that looks among the edges of its world behind it.
typedef struct {
  u32 primitive;  // index of the point, or index of the edge | IS_EDGE
  u32 slot;       // of the edge's own leaf
  u32 world;
  u32 body;  // of the primitive, over all worlds
} Query;
SHARED_SIZE(Query, 16);
SHARED_END
#endif
