// Stage 3, one path a work-item: what render/shade_path.cl does.
#define PVG_INLINE_ALL
#include "shared/pocl.h"

#include "render/shade_path.cl"

// as in generate.cl and intersect.cl;  depth: bounces so far;  shadow_..., feature_...: [n_slots], as in shade_path.cl;
// alive: [n] by place in the queue
kernel void shade(const uint n, const Launch launch, const uint depth, const uint notes_features,
                  global uint* restrict queue, global uint2* restrict stream,
                  global const Instance* restrict instances, global const Material* restrict materials,
                  global const TextureInfo* restrict textures, global const uchar4* restrict texels,
                  constant float* restrict decode, global const uint* restrict triangles,
                  global const Vertex* restrict vertices, global const float* restrict colors,
                  global const float* restrict second_uvs, global const Light* restrict lights,
                  global const float* restrict environment, global const EnvironmentCell* restrict cells,
                  global const float4* restrict targets, global float4* restrict hit, global uint* restrict hit_instance,
                  global float4* restrict origin, global float4* restrict direction, global float4* restrict throughput,
                  global float4* restrict radiance, global float4* restrict shadow_origin,
                  global float4* restrict shadow_direction, global float4* restrict shadow_light,
                  global uint* restrict alive, global float4* restrict feature_color,
                  global float4* restrict feature_normal) {
  const uint i = get_global_id(0);
  if (i >= n) return;
  const Shading scene = {instances, materials, textures,   texels, decode,      triangles,
                         vertices,  colors,    second_uvs, lights, environment, cells,       targets};
  const Slots slots = {queue, alive, stream, origin, direction, throughput, radiance, hit, hit_instance, shadow_origin,
                       shadow_direction, shadow_light, feature_color, feature_normal};
  shade_path(launch, scene, depth, notes_features, i, slots);
}
