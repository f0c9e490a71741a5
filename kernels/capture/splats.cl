// Depth of Gaussian splats: along a pixel's ray each is felt where its density is largest, with alpha = opacity
// exp(-r^2 / 2), r the ray's distance in standard deviations; exact for flat splats too, of which this is where the ray
// meets their plane. From near to far the light that is left is multiplied by 1 - alpha (Kerbl et al. 2023); the depth is
// where it falls to a share. Sorted by centres, per tile of pixels, on the host.
#include "capture/splats.h"
#include "sensors/camera.cl"

#define LEAST_ALPHA 0.004f  // 1/255, as in 3DGS

static inline float3 whitened(global const Splat* restrict splat, const float3 v) {
  return (float3)(dot(vload3(0, splat->whiten), v), dot(vload3(1, splat->whiten), v), dot(vload3(2, splat->whiten), v));
}

// splats: [n];  first: [n_tiles + 1] into order;  order: the splats of each tile, from near to far;
// depth: [height x width, m], 0: less than the share is absorbed
kernel void blend_splats(const uint n_pixels, const PinholeCamera camera, const float share,
                         global const Splat* restrict splats, global const uint* restrict first,
                         global const uint* restrict order, global float* restrict depth) {
  const uint i = get_global_id(0);
  if (i >= n_pixels) return;
  const uint x = i % camera.width, y = i / camera.width;
  const uint n_columns = (camera.width + SPLAT_TILE - 1u) / SPLAT_TILE;
  const uint tile = y / SPLAT_TILE * n_columns + x / SPLAT_TILE;
  float3 ray = (float3)(0, 0, 1);
  depth[i] = 0;
  if (!pixel_direction(camera, (float2)(x, y), &ray)) return;
  const float3 direction = camera_vector(camera, ray / ray.z);  // one metre of depth long
  const float3 eye = (float3)(camera.to_world[3], camera.to_world[7], camera.to_world[11]);
  float left = 1;
  for (uint k = first[tile]; k < first[tile + 1]; ++k) {
    global const Splat* splat = splats + order[k];
    const float3 o = whitened(splat, eye - vload3(0, splat->center)), d = whitened(splat, direction);
    const float along = -dot(o, d) / dot(d, d);
    if (!(along > 0)) continue;
    const float3 off = o + along * d;
    const float alpha = splat->opacity * exp(-0.5f * dot(off, off));
    if (!(alpha >= LEAST_ALPHA)) continue;
    left *= 1.0f - alpha;
    if (left <= 1.0f - share) {
      depth[i] = along;
      return;
    }
  }
}
