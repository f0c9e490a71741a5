// Stage 1: starts the paths of a batch, one per sample, at the camera. A pixel's samples are spread over its square
// (box filter), and over the lens, which throws every point of the plane in focus to one point of the picture. Neighbouring slots are samples of one
// pixel, then pixels that are neighbours in the launch's list.
#define PVG_INLINE_ALL
#include "shared/pocl.h"

#include "render/path.h"
#include "materials/diffuse.cl"
#include "sensors/camera.cl"
#include "shared/rng.cl"

// origin: [n, m], w: density of the last direction;  direction: [n], w: stack of the glasses that the path is inside
// of;  pixels: places in the picture, of which the launch takes some;  throughput: [n], w: path flags;  radiance: [n];  stream: [n] key and sample of the random numbers of a path;
// queue: [n] live slots
kernel void generate(const uint n, const Launch launch, global const uint* restrict pixels,
                     global float4* restrict origin,
                     global float4* restrict direction, global float4* restrict throughput,
                     global float4* restrict radiance, global uint2* restrict stream, global uint* restrict queue) {
  const uint i = get_global_id(0);
  if (i >= n) return;
  const PinholeCamera c = launch.camera;
  const uint sample = launch.first_sample + i % launch.n_samples;
  const uint pixel = pixels[launch.first_pixel + i / launch.n_samples];
  const uint key = hash_combine(launch.key, pixel);
  float2 at = (float2)((float)(pixel % c.width), (float)(pixel / c.width));
  if (!launch.is_center) at += sample_2d(key, sample, 0) - (float2)(0.5f, 0.5f);
  float3 d = (float3)(0, 0, 1), from = (float3)(0.0f);
  const bool is_seen = pixel_direction(c, at, &d);
  if (c.lens_radius > 0 && !launch.is_center) {
    const float2 lens = c.lens_radius * uniform_disc(sample_2d(key, sample, 1));
    from = (float3)(lens, 0);
    d = d * (c.focus_distance / d.z) - from;
  }
  from = camera_vector(c, from) + (float3)(c.to_world[3], c.to_world[7], c.to_world[11]);
  origin[i] = (float4)(from, 0);
  direction[i] = (float4)(normalize(camera_vector(c, d)), as_float(launch.media));
  throughput[i] = (float4)((float3)(is_seen ? 1.0f : 0.0f), as_float(0u));
  radiance[i] = (float4)(0.0f);
  stream[i] = (uint2)(key, sample);
  queue[i] = i;
}
