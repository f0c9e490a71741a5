// What guides a denoiser, noted.cl, summed over the samples of each pixel, each by its weight.
#include "render/path.h"

// feature_color, feature_normal: [n_pixels x n_samples], as in noted.cl;  guide_color, guide_normal: [height x width]
// sums over the samples, in their order, as accumulate.cl;  w: sum of the weights
kernel void accumulate_features(const uint n_pixels, const Launch launch, global const uint* restrict pixels,
                                global const float4* restrict feature_color,
                                global const float4* restrict feature_normal, global float4* restrict guide_color,
                                global float4* restrict guide_normal) {
  const uint i = get_global_id(0);
  if (i >= n_pixels) return;
  const uint at = pixels[launch.first_pixel + i];
  float4 color = guide_color[at], normal = guide_normal[at];
  for (uint s = 0; s < launch.n_samples; ++s) {
    const float4 noted = feature_color[i * launch.n_samples + s];
    color += (float4)(noted.w * noted.xyz, noted.w);
    normal += (float4)(noted.w * feature_normal[i * launch.n_samples + s].xyz, noted.w);
  }
  guide_color[at] = color;
  guide_normal[at] = normal;
}
