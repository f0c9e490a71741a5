// Colours of a surface's points from photos: the mean over the photos that see a point, in linear light. A photo sees it
// where its own picture of depth is there too. Two passes: the second takes the first one's mean and trusts a photo
// less the farther its colour lies from it (weight 1 / (1 + (c / spread)^2)), so that what passed by leaves no trace.
#include "capture/voxels.h"
#include "sensors/camera.cl"

#define COLOR_SPREAD 0.05f  // of linear light

static inline float3 texel(global const uchar4* restrict photo, const uint width, const int x, const int y,
                           global const float* restrict decode) {
  const uchar4 c = photo[(uint)y * width + (uint)x];
  return (float3)(decode[c.x], decode[c.y], decode[c.z]);
}

// points, normals: [n x 3, m];  depth: [height x width of depth_camera, m];  photo: [height x width of color_camera]
// sRGB;  decode: [256] byte to linear;  before: [n] xyz: mean of the first pass, w: 0 in it;
// sums: [n] xyz: weighted colours, w: weights
kernel void add_colors(const uint n, const PinholeCamera depth_camera, const PinholeCamera color_camera,
                       const float tolerance, global const float* restrict points,
                       global const float* restrict normals, global const float* restrict depth,
                       global const uchar4* restrict photo, global const float* restrict decode,
                       global const float4* restrict before, global float4* restrict sums) {
  const uint i = get_global_id(0);
  if (i >= n) return;
  const float3 point = vload3(i, points), normal = vload3(i, normals);
  const float3 p = in_camera(depth_camera, point);
  float2 pixel;
  if (!project(depth_camera, p, &pixel)) return;
  int2 at = convert_int2_rtn(pixel + 0.5f);
  if (at.x < 0 || at.y < 0 || at.x >= (int)depth_camera.width || at.y >= (int)depth_camera.height) return;
  const float z = depth[(uint)at.y * depth_camera.width + (uint)at.x];
  if (!(z > 0 && fabs(z - p.z) < tolerance * (1.0f + p.z * p.z))) return;
  const float3 eye = (float3)(color_camera.to_world[3], color_camera.to_world[7], color_camera.to_world[11]) - point;
  const float cosine = dot(normal, eye) / (length(eye) * length(normal));
  if (!(cosine > 0.1f) || !project(color_camera, in_camera(color_camera, point), &pixel)) return;
  at = convert_int2_rtn(pixel);
  const int w = (int)color_camera.width, h = (int)color_camera.height;
  if (at.x < 0 || at.y < 0 || at.x + 1 >= w || at.y + 1 >= h) return;
  const float2 f = pixel - convert_float2(at);
  const float3 top = mix(texel(photo, w, at.x, at.y, decode), texel(photo, w, at.x + 1, at.y, decode), f.x);
  const float3 low = mix(texel(photo, w, at.x, at.y + 1, decode), texel(photo, w, at.x + 1, at.y + 1, decode), f.x);
  const float3 color = mix(top, low, f.y);
  // finer where the photo was near and looked straight on
  float weight = cosine * cosine / dot(eye, eye);
  weight *= weight;
  if (before[i].w > 0) {
    const float3 off = (color - before[i].xyz) / COLOR_SPREAD;
    weight /= 1.0f + dot(off, off);
  }
  sums[i] += (float4)(weight * color, weight);
}

// means: [n] sums divided by their weight; w as it was
kernel void mean_colors(const uint n, global const float4* restrict sums, global float4* restrict before) {
  const uint i = get_global_id(0);
  if (i >= n) return;
  const float w = sums[i].w;
  before[i] = w > 0 ? (float4)(sums[i].xyz / w, w) : (float4)(0.0f);
}
