// The paths under way. Arrays are [n_slots] unless said otherwise; what their elements hold, fourth parts too: generate.cl,
// render/wavefront/intersect.cl and shade_path.cl
#ifndef PVG_RENDER_SLOTS_CL
#define PVG_RENDER_SLOTS_CL
#include "render/path.h"

typedef struct {
  global uint* queue;    // [n live paths] their slots
  global uint* alive;    // [n live paths], by place in the queue: does the path go on? 0 or 1
  global uint2* stream;  // key and number of the sample: its random numbers
  global float4 *origin, *direction, *throughput, *radiance;
  global float4* hit;
  global uint* hit_instance;
  global float4 *shadow_origin, *shadow_direction, *shadow_light;
  global float4 *feature_color, *feature_normal;  // not read where nothing is noted
} Slots;
#endif
