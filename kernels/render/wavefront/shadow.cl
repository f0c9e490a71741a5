// Stage 4: any hit between a surface and the light sample that it chose; what arrives is added to the path.
#include "render/transmittance.cl"

// shadow_...: as in shade_path.cl;  radiance: [n_slots]
kernel void shadow(const uint n, global const uint* restrict queue, const uint transparent_shadows,
                   global const float8* restrict top, global const float8* restrict nodes,
                   global const float4* restrict blocks, global const Instance* restrict instances,
                   global const Material* restrict materials, global const float4* restrict shadow_origin,
                   global const float4* restrict shadow_direction, global const float4* restrict shadow_light,
                   global float4* restrict radiance) {
  const uint i = get_global_id(0);
  if (i >= n) return;
  const uint slot = queue[i];
  const float4 from = shadow_origin[slot];
  const uint kind = as_uint(from.w);
  if (kind == SHADOW_NONE) return;
  const Trees trees = {top, nodes, blocks, instances};
  const int passes_glass = kind == SHADOW_SURFACE_GLASS || (kind == SHADOW_RECEIVER && transparent_shadows);
  const uint mask = kind == SHADOW_RECEIVER ? MASK_RECEIVERS : MASK_SURFACES;
  const float3 direction = shadow_direction[slot].xyz;
  if (!passes_glass) {
    if (any_hit(trees, from.xyz, direction, BEFORE_LIGHT, mask)) return;
    const float4 light = shadow_light[slot];
    radiance[slot] += (float4)(light.xyz * light.w, 0);
    return;
  }
  const Transmittance T = transmittance(trees, materials, from.xyz, direction, BEFORE_LIGHT, mask);
  const float4 light = shadow_light[slot];
  // behind glass the light sample stands alone, see shade_path.cl
  radiance[slot] += (float4)(light.xyz * T.value * (T.has_crossed ? 1.0f : light.w), 0);
}
