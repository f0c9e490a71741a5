// What guides a denoiser, noted.cl, summed over the samples of each pixel.
#include "render/path.h"

// feature_color, feature_normal: [n_pixels x n_samples], as in noted.cl;  guide_color, guide_normal: [height x width] sums over the samples, in their order, as accumulate.cl
kernel void accumulate_features(const uint n_pixels, const Launch launch, global const uint* restrict pixels,
                                global const float4* restrict feature_color,
                                global const float4* restrict feature_normal, global float4* restrict guide_color,
                                global float4* restrict guide_normal) {
  const uint i = get_global_id(0);
  if (i >= n_pixels) return;
  const uint at = pixels[launch.first_pixel + i];
  float4 color = guide_color[at], normal = guide_normal[at];
  for (uint s = 0; s < launch.n_samples; ++s) {
    color += (float4)(feature_color[i * launch.n_samples + s].xyz, 1);
    normal += (float4)(feature_normal[i * launch.n_samples + s].xyz, 1);
  }
  guide_color[at] = color;
  guide_normal[at] = normal;
}
