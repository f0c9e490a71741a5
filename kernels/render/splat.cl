// Light tracing, stage 3: what reaches the camera goes to its pixel, where light paths meet in any order. Sums of whole
// numbers do not depend on it: 64 bits of two words each, in units of 2^-36 of white.
#include "render/traverse.cl"

#define SPLAT_UNIT 0x1p-36f
#define MOST_SPLAT 0x1p62f

// OpenCL 1.2 adds 32 bits at a time: the carry goes up
static inline void add_splat(volatile global uint* word, const float value) {
  const ulong x = (ulong)(value * (1.0f / SPLAT_UNIT));
  const uint low = (uint)x, before = atomic_add(word, low);
  const uint high = (uint)(x >> 32) + (before + low < before ? 1u : 0u);
  if (high) atomic_add(word + 1, high);
}

// shadow_...: as in follow.cl;  splats: [height x width x 3 x 2] low and high words;  dropped: [height x width]
kernel void splat(const uint n, global const uint* restrict queue, global const float8* restrict top,
                  global const float8* restrict nodes, global const float4* restrict blocks,
                  global const Instance* restrict instances, global const float4* restrict shadow_origin,
                  global const float4* restrict shadow_direction, global const float4* restrict shadow_light,
                  volatile global uint* restrict splats, volatile global uint* restrict dropped) {
  const uint i = get_global_id(0);
  if (i >= n) return;
  const uint slot = queue[i];
  const float4 from = shadow_origin[slot], way = shadow_direction[slot];
  if (as_uint(from.w) == SHADOW_NONE) return;
  const Trees trees = {top, nodes, blocks, instances};
  if (any_hit(trees, from.xyz, way.xyz, BEFORE_LIGHT, MASK_SURFACES)) return;
  const float3 light = shadow_light[slot].xyz;
  const uint pixel = as_uint(way.w);
  if (!(light.x + light.y + light.z < MOST_SPLAT * SPLAT_UNIT)) {
    atomic_inc(dropped + pixel);
    return;
  }
  add_splat(splats + 6 * pixel, light.x);
  add_splat(splats + 6 * pixel + 2, light.y);
  add_splat(splats + 6 * pixel + 4, light.z);
}

// to the means of the film, which are sums over samples
kernel void add_splats(const uint n_pixels, const Launch launch, global const uint* restrict splats,
                       global float4* restrict film) {
  const uint at = get_global_id(0);
  if (at >= n_pixels) return;
  float words[3];
  for (uint c = 0; c < 3; ++c) {
    const ulong sum = ((ulong)splats[6 * at + 2 * c + 1] << 32) | splats[6 * at + 2 * c];
    words[c] = (float)sum * SPLAT_UNIT;
  }
  const float3 light = (float3)(words[0], words[1], words[2]) * launch.receiver_scale;
  film[at] += (float4)(light * film[at].w, 0);
}
