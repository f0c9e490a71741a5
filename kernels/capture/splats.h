// A Gaussian splat, shared with the host.
#ifndef PVG_CAPTURE_SPLATS_H
#define PVG_CAPTURE_SPLATS_H
#include "shared/types.h"

#define SPLAT_TILE 16u  // pixels along a tile's edge

SHARED_BEGIN
typedef struct {
  f32 center[3];   // [m]
  f32 opacity;     // at the centre, in [0, 1]
  f32 whiten[9];   // rows: to units of its standard deviations along its own axes [1/m]
  f32 radius;      // beyond, it is left out: three standard deviations of the longest axis [m]
  f32 padding[2];
} Splat;
SHARED_SIZE(Splat, 64);
SHARED_END
#endif
