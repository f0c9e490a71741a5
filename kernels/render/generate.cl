// Stage 1: starts the paths of a batch, one per sample, at the camera. A pixel's samples are spread over its square
// (box filter), and over the lens, which throws every point of the plane in focus to one point of the picture.
// Neighbouring slots are samples of one pixel, then pixels that are neighbours in the launch's list.
// PATHS of them start at once, 16 on a CPU, which draws their random numbers side by side.
#ifndef PVG_RENDER_GENERATE_CL
#define PVG_RENDER_GENERATE_CL
#include "materials/diffuse.cl"
#include "render/path.h"
#include "render/slots.cl"
#include "sensors/camera.cl"
#include "shared/pocl.h"
#include "shared/rng.cl"

#ifndef PATHS
#define PATHS 1
#endif

typedef struct {
  float x[PATHS], y[PATHS];
} Points;  // one of each path

ALWAYS_INLINE void draw_points(const uint* key, const uint* sample, const uint dimension, Points* points) {
#if PATHS == 16
  float16 x, y;
  sample_2d_16(vload16(0, key), vload16(0, sample), dimension, &x, &y);
  vstore16(x, 0, points->x);
  vstore16(y, 0, points->y);
#else
  const float2 point = sample_2d(key[0], sample[0], dimension);
  points->x[0] = point.x;
  points->y[0] = point.y;
#endif
}

typedef struct {
  float3 origin, direction;  // [m], unit
  bool is_seen;              // false: the camera sees nothing there
} CameraRay;

static inline bool has_lens(const Launch launch) { return launch.camera.lens_radius > 0 && !launch.is_center; }

// pixel: its place y width + x;  in_pixel, in_lens: random numbers
static inline CameraRay camera_ray(const Launch launch, const uint pixel, const float2 in_pixel, const float2 in_lens) {
  const PinholeCamera c = launch.camera;
  float2 at = (float2)((float)(pixel % c.width), (float)(pixel / c.width));
  if (!launch.is_center) at += in_pixel - (float2)(0.5f, 0.5f);
  float3 d = (float3)(0, 0, 1), from = (float3)(0.0f);
  CameraRay ray;
  ray.is_seen = pixel_direction(c, at, &d);
  if (has_lens(launch)) {
    const float2 lens = c.lens_radius * uniform_disc(in_lens);
    from = (float3)(lens, 0);
    d = d * (c.focus_distance / d.z) - from;
  }
  ray.origin = camera_vector(c, from) + (float3)(c.to_world[3], c.to_world[7], c.to_world[11]);
  ray.direction = normalize(camera_vector(c, d));
  return ray;
}

// Numbers of PATHS of the n paths of a launch, from number first on; those beyond the last are the last one's. pixel: place
// in the picture;  key, sample: of its random numbers
static inline void number_paths(const Launch launch, global const uint* pixels, const uint first, const uint n,
                                uint* pixel, uint* key, uint* sample) {
  uint at = first / launch.n_samples, sample_at = first % launch.n_samples;
  for (uint k = 0; k < PATHS; ++k) {
    pixel[k] = pixels[launch.first_pixel + at];
    key[k] = hash_combine(launch.key, pixel[k]);
    sample[k] = launch.first_sample + sample_at;
    if (first + k + 1 >= n) continue;
    sample_at = sample_at + 1 < launch.n_samples ? sample_at + 1 : 0;
    at += sample_at == 0;
  }
}

// starts these paths in the slots from `slot` on. pixels: places in the picture, of which the launch takes some. What
// stands in fourth parts: of origin the density of the last direction, of direction the stack of the glasses that the path
// is inside of, of throughput its flags
static inline void start_paths(const Launch launch, global const uint* pixels, const uint first, const uint n,
                               const uint slot, const Slots slots) {
  uint pixel[PATHS], key[PATHS], sample[PATHS];
  number_paths(launch, pixels, first, n, pixel, key, sample);
  Points in_pixel = {{0}, {0}}, in_lens = in_pixel;
  if (!launch.is_center) draw_points(key, sample, 0, &in_pixel);
  if (has_lens(launch)) draw_points(key, sample, 1, &in_lens);
  for (uint k = 0; k < PATHS && first + k < n; ++k) {
    const uint i = slot + k;
    const CameraRay ray = camera_ray(launch, pixel[k], (float2)(in_pixel.x[k], in_pixel.y[k]),
                                     (float2)(in_lens.x[k], in_lens.y[k]));
    slots.origin[i] = (float4)(ray.origin, 0);
    slots.direction[i] = (float4)(ray.direction, as_float(launch.media));
    slots.throughput[i] = (float4)((float3)(ray.is_seen ? 1.0f : 0.0f), as_float(0u));
    slots.radiance[i] = (float4)(0.0f);
    slots.stream[i] = (uint2)(key[k], sample[k]);
    slots.queue[i] = i;
  }
}
#endif
