// The paths under way, by slot. What stands in fourth parts: generate.cl and shade_path.cl
#ifndef PVG_RENDER_SLOTS_CL
#define PVG_RENDER_SLOTS_CL
#include "render/path.h"

typedef struct {
  global uint* queue;  // slots of the live paths
  global uint* alive;  // by place in the queue: does the path go on?
  global uint2* stream;  // key and sample of the random numbers
  global float4 *origin, *direction, *throughput, *radiance;
  global float4* hit;
  global uint* hit_instance;
  global float4 *shadow_origin, *shadow_direction, *shadow_light;
  global float4 *feature_color, *feature_normal;  // 0 where nothing is noted
} Slots;
#endif
