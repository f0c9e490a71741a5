// Stage 5: adds the samples of each pixel in their order to what is there. Samples that are not finite are left out and counted.
#include "render/path.h"

// radiance: [n_pixels x n_samples];  film: [height x width], sum of radiance, w: samples in it;  squares: [height x
// width], sum of their squared luminance;  dropped: [height x
// width]
kernel void accumulate(const uint n_pixels, const Launch launch, global const uint* restrict pixels,
                       global const float4* restrict radiance, global float4* restrict film, global float* restrict squares,
                       global uint* restrict dropped) {
  const uint i = get_global_id(0);
  if (i >= n_pixels) return;
  const uint at = pixels[launch.first_pixel + i];
  float4 sum = film[at];
  float sum_of_squares = squares[at];
  uint n_dropped = dropped[at];
  for (uint s = 0; s < launch.n_samples; ++s) {
    const float4 L = radiance[i * launch.n_samples + s];
    if (!(isfinite(L.x) && isfinite(L.y) && isfinite(L.z))) {
      ++n_dropped;
      continue;
    }
    const float luminance = 0.2126f * L.x + 0.7152f * L.y + 0.0722f * L.z;
    sum += (float4)(L.x, L.y, L.z, 1);
    sum_of_squares += luminance * luminance;
  }
  film[at] = sum;
  squares[at] = sum_of_squares;
  dropped[at] = n_dropped;
}
