// Stage 1, PATHS paths a work-item: generate.cl.
#define PVG_INLINE_ALL
#include "shared/pocl.h"

#include "render/generate.cl"

// pixels: places in the picture;  queue, origin, direction, throughput, radiance: [n];  stream: [n] key and sample of the
// random numbers of a path
kernel void generate(const uint n, const Launch launch, global const uint* restrict pixels,
                     global float4* restrict origin, global float4* restrict direction,
                     global float4* restrict throughput, global float4* restrict radiance,
                     global uint2* restrict stream, global uint* restrict queue) {
  const uint first = get_global_id(0) * PATHS;
  const Slots slots = {queue, 0, stream, origin, direction, throughput, radiance, 0, 0, 0, 0, 0, 0, 0};
  if (first < n) start_paths(launch, pixels, first, n, first, slots);
}
