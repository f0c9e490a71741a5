// Colours of a surface's points from photos: the mean over the photos that see a point, in linear light. A photo sees it
// where the surface, drawn from the photo's place, is there too. Two passes: the second takes the first one's mean and
// trusts a photo less the farther its colour lies from it (weight 1 / (1 + (c / spread)^2)), so that what passed by
// leaves no trace.
#include "capture/voxels.h"
#include "sensors/camera.cl"

#define COLOR_SPREAD 0.1f  // of linear light
#define SATURATED 250       // bytes from here on may be cut; they count little
#define SATURATED_WEIGHT 0.05f

// decode: [3 x 256] byte to linear light, with the photo's gain of each channel
static inline float3 texel(global const uchar4* restrict photo, const uint width, const int x, const int y,
                           global const float* restrict decode) {
  const uchar4 c = photo[(uint)y * width + (uint)x];
  return (float3)(decode[c.x], decode[256 + c.y], decode[512 + c.z]);
}

// xyz: what a photo shows of a point, w: its weight, finer where it was near and looked straight on; 0: not seen
static inline float4 seen_color(const PinholeCamera camera, const float tolerance, const float3 point,
                                const float3 normal, global const float* restrict depth,
                                global const uchar4* restrict photo, global const float* restrict decode) {
  const float3 p = in_camera(camera, point);
  const int w = (int)camera.width, h = (int)camera.height;
  float2 pixel;
  if (!project(camera, p, &pixel)) return (float4)(0.0f);
  const int2 nearest = convert_int2_rtn(pixel + 0.5f), at = convert_int2_rtn(pixel);
  if (at.x < 0 || at.y < 0 || at.x + 1 >= w || at.y + 1 >= h) return (float4)(0.0f);
  const float z = depth[nearest.y * w + nearest.x];
  if (!(z > 0 && fabs(z - p.z) < tolerance * (1.0f + p.z * p.z))) return (float4)(0.0f);
  const float3 eye = (float3)(camera.to_world[3], camera.to_world[7], camera.to_world[11]) - point;
  const float cosine = dot(normal, eye) / (length(eye) * length(normal));
  if (!(cosine > 0.1f)) return (float4)(0.0f);
  const float2 f = pixel - convert_float2(at);
  const float3 top = mix(texel(photo, w, at.x, at.y, decode), texel(photo, w, at.x + 1, at.y, decode), f.x);
  const float3 low = mix(texel(photo, w, at.x, at.y + 1, decode), texel(photo, w, at.x + 1, at.y + 1, decode), f.x);
  const uchar4 byte = photo[nearest.y * w + nearest.x];
  float weight = cosine * cosine / dot(eye, eye);
  if (max(byte.x, max(byte.y, byte.z)) >= SATURATED) weight *= SATURATED_WEIGHT;
  return (float4)(mix(top, low, f.y), weight);
}

// points, normals: [n x 3, m];  depth: [height x width, m] of the surface, 0: none;  photo: [height x width] sRGB;
// seen: [n] colours and weights of one photo
kernel void see_colors(const uint n, const PinholeCamera camera, const float tolerance,
                       global const float* restrict points, global const float* restrict normals,
                       global const float* restrict depth, global const uchar4* restrict photo,
                       global const float* restrict decode, global float4* restrict seen) {
  const uint i = get_global_id(0);
  if (i >= n) return;
  seen[i] = seen_color(camera, tolerance, vload3(i, points), vload3(i, normals), depth, photo, decode);
}

// before: [n] xyz: mean of the first pass, w: 0 in it;  sums: [n] xyz: weighted colours, w: weights
kernel void add_colors(const uint n, const PinholeCamera camera, const float tolerance,
                       global const float* restrict points, global const float* restrict normals,
                       global const float* restrict depth, global const uchar4* restrict photo,
                       global const float* restrict decode, global const float4* restrict before,
                       global float4* restrict sums) {
  const uint i = get_global_id(0);
  if (i >= n) return;
  const float4 seen = seen_color(camera, tolerance, vload3(i, points), vload3(i, normals), depth, photo, decode);
  if (!(seen.w > 0)) return;
  float weight = seen.w;
  if (before[i].w > 0) {
    const float3 off = (seen.xyz - before[i].xyz) / COLOR_SPREAD;
    weight /= 1.0f + dot(off, off);
  }
  sums[i] += (float4)(weight * seen.xyz, weight);
}

// means: [n] sums divided by their weight; w as it was
kernel void mean_colors(const uint n, global const float4* restrict sums, global float4* restrict before) {
  const uint i = get_global_id(0);
  if (i >= n) return;
  const float w = sums[i].w;
  before[i] = w > 0 ? (float4)(sums[i].xyz / w, w) : (float4)(0.0f);
}
