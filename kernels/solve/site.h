// A site is a point (or a direction) carried by at most four nodes: x_site = sum_k weight[k] x_node[k].
// A vertex of a soft body is one node with weight 1; a point X of an affine body is (p, a1, a2, a3) with (1, X);
// a direction d of an affine body is the same with (0, d).
#ifndef PVG_SITE_H
#define PVG_SITE_H
#include "shared/types.h"

SHARED_BEGIN
typedef struct {
  u32 node[4];    // indices into the nodes
  f64 weight[4];  // 0 where unused  [-] for points, [m] for the axes' part
} Site;
SHARED_SIZE(Site, 48);

// A run of consecutive elements that one work-item sums; runs never cross worlds.
typedef struct {
  u32 begin, end;  // elements
  u32 world;
  u32 pad_;
} Chunk;
SHARED_SIZE(Chunk, 16);
SHARED_END
#endif
