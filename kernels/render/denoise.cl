// Edge-avoiding filter for previews: an a-trous wavelet (Dammertz et al. 2010) over the light without the surface's own
// colour, each pixel's weight falling with the difference of normal, plane and light, the latter in units of its own
// noise (as in Schied et al. 2017). Pixels at the border of two things are left as they are: they are mixtures.
#include "render/path.h"

#define PLANE_DISTANCE 0.01f  // of a neighbour off this pixel's plane, as a share of the distance to the camera
#define NOISE_WIDTH 3.0f      // standard deviations
#define LEAST_COLOR 0.01f     // that light is divided by
#define LEAST_WEIGHT 1e-6f    // that sums of guides are divided by

// similarity of two normals: the 64th power of their angle's cosine, by squaring (`pow` took two fifths of a picture)
static inline float normal_weight(const float cosine) {
  float power = max(0.0f, cosine);
  for (int i = 0; i < 6; ++i) power *= power;
  return power;
}

static inline float luminance(const float3 c) { return dot(c, (float3)(0.2126f, 0.7152f, 0.0722f)); }

// of what a pixel shows: the mean over its own samples, so that what is finer than a pixel is in it as in the light
static inline float3 mean_color(const float4 guide) {
  return max(guide.xyz / max(guide.w, LEAST_WEIGHT), (float3)(LEAST_COLOR));
}

// film, guide_color: sums, w: samples;  squares: sum of squared luminance;  light: [height x width] mean without the
// colour, w: variance of its luminance
kernel void denoise_begin(const uint n_pixels, global const float4* restrict film, global const float* restrict squares,
                          global const float4* restrict guide_color, global float4* restrict light) {
  const uint i = get_global_id(0);
  if (i >= n_pixels) return;
  const float n = film[i].w;
  const float3 color = mean_color(guide_color[i]);
  if (n < 2) {
    light[i] = (float4)(n > 0 ? film[i].xyz / color : (float3)(0.0f), 0);
    return;
  }
  const float3 mean = film[i].xyz / n;
  const float L = luminance(mean), scale = luminance(color);
  light[i] = (float4)(mean / color, max(0.0f, squares[i] / n - L * L) / ((n - 1.0f) * scale * scale));
}

// the variance is noisy itself: means over 3 x 3 pixels of the same thing.  is_border: another thing is among them
kernel void denoise_variance(const uint n_pixels, const uint width, const uint height,
                             global const uint* restrict instance, global const float4* restrict from,
                             global float4* restrict to, global uint* restrict is_border) {
  const uint i = get_global_id(0);
  if (i >= n_pixels) return;
  const int x = (int)(i % width), y = (int)(i / width);
  float sum = 0, n = 0;
  uint border = 0;
  for (int dy = -1; dy <= 1; ++dy)
    for (int dx = -1; dx <= 1; ++dx) {
      const int u = x + dx, v = y + dy;
      if (u < 0 || v < 0 || u >= (int)width || v >= (int)height) continue;
      const uint k = (uint)v * width + (uint)u;
      if (instance[k] != instance[i]) {
        border = 1;
        continue;
      }
      sum += from[k].w;
      n += 1.0f;
    }
  to[i] = (float4)(from[i].xyz, sum / n);
  is_border[i] = border;
}

// one pass; step: between the taps [pixels]
kernel void denoise_pass(const uint n_pixels, const uint width, const uint height, const int step,
                         global const uint* restrict instance, global const float* restrict normal,
                         global const float4* restrict place, global const uint* restrict is_border,
                         global const float4* restrict from, global float4* restrict to) {
  const uint i = get_global_id(0);
  if (i >= n_pixels) return;
  const float4 here = from[i];
  to[i] = here;
  if (is_border[i] || instance[i] == 0) return;
  const float kernel_1d[3] = {0.375f, 0.25f, 0.0625f};
  const int x = (int)(i % width), y = (int)(i / width);
  const float3 n = vload3(i, normal), p = place[i].xyz;
  const float L = luminance(here.xyz), near = PLANE_DISTANCE * place[i].w;
  float4 sum = (float4)(0.0f);
  float weights = 0;
  for (int dy = -2; dy <= 2; ++dy)
    for (int dx = -2; dx <= 2; ++dx) {
      const int u = x + dx * step, v = y + dy * step;
      if (u < 0 || v < 0 || u >= (int)width || v >= (int)height) continue;
      const uint k = (uint)v * width + (uint)u;
      if (is_border[k] || instance[k] != instance[i]) continue;
      const float off = dot(n, place[k].xyz - p) / near;
      const float4 there = from[k];
      const float noise = NOISE_WIDTH * sqrt(here.w + there.w) + 1e-6f;
      const float difference = (luminance(there.xyz) - L) / noise;
      const float w = kernel_1d[abs(dx)] * kernel_1d[abs(dy)] * normal_weight(dot(n, vload3(k, normal))) *
                      exp(-off * off - difference * difference);
      sum += (float4)(w * there.xyz, w * w * there.w);
      weights += w;
    }
  if (weights > 0) to[i] = (float4)(sum.xyz / weights, sum.w / (weights * weights));
}

// back to sums of as many samples as there were
kernel void denoise_end(const uint n_pixels, global const float4* restrict light,
                        global const float4* restrict guide_color, global float4* restrict film) {
  const uint i = get_global_id(0);
  if (i < n_pixels) film[i] = (float4)(light[i].xyz * mean_color(guide_color[i]) * film[i].w, film[i].w);
}
