// What guides a denoiser: colour and normal of the first surface that scatters, met by the same paths that bring the
// light. So they are spread over the pixel and its exposure as the light is, and are seen through clear glass and in
// mirrors.
#define PVG_INLINE_ALL
#include "shared/pocl.h"

#include "render/interact.cl"

// the share of white light that the surface scatters back or shines, at most 1
static inline float3 scattered_color(const Shading scene, global const Instance* instance, const Material m,
                                     const Surface s, const uint triangle, const float u, const float v) {
  float3 color = vload3(0, m.color);
  if (m.kind == MATERIAL_EMISSIVE)
    color = (float3)(0.0f);
  else if (m.texture >= 0)
    color *= texture_color(scene.textures[m.texture], scene.texels, scene.decode, uv_for(s, m.flags, SECOND_UVS_COLOR));
  if (instance->flags & INSTANCE_COLORS) color *= vertex_color(instance, scene.triangles, scene.colors, triangle, u, v);
  if (m.flags & MATERIAL_EMITS) color += emitted(scene, m, uv_for(s, m.flags, emission_bit(m)));
  return clamp(color, 0.0f, 1.0f);
}

// Once per segment, after `intersect`. A path that has scattered keeps what it has. feature_color: [n_slots] in [0, 1];
// feature_normal: [n_slots] unit, world, toward the path, or 0; their w: unused. Else as in shade.cl
kernel void note_features(const uint n, const Launch launch, global const uint* restrict queue,
                          global const Instance* restrict instances, global const Material* restrict materials,
                          global const TextureInfo* restrict textures, global const uchar4* restrict texels,
                          constant float* restrict decode, global const uint* restrict triangles,
                          global const Vertex* restrict vertices, global const float* restrict colors,
                          global const float* restrict second_uvs, global const Light* restrict lights,
                          global const float* restrict environment, global const EnvironmentCell* restrict cells,
                          global const float4* restrict hit, global const uint* restrict hit_instance,
                          global const float4* restrict direction, global const float4* restrict throughput,
                          global float4* restrict feature_color, global float4* restrict feature_normal) {
  const uint i = get_global_id(0);
  if (i >= n) return;
  const uint slot = queue[i];
  const float4 carried = throughput[slot], h = hit[slot];
  if (as_uint(carried.w) & PATH_SCATTERED) return;
  const uint triangle = as_uint(h.w);
  const float3 d = direction[slot].xyz;
  const Shading scene = {instances, materials, textures,   texels, decode,      triangles,
                         vertices,  colors,    second_uvs, lights, environment, cells,       0};
  float3 color = (float3)(1.0f), normal = (float3)(0.0f);
  if (triangle == NO_TRIANGLE) {
    color = clamp(environment_radiance(launch, environment, d), 0.0f, 1.0f);
  } else {
    const Surface s = surface_with_uvs(scene, hit_instance[slot], triangle, h.y, h.z);
    global const Instance* instance = instances + hit_instance[slot];
    normal = dot(s.shading, d) < 0 ? s.shading : -s.shading;
    if (instance->visual != 0) {
      const Material m = materials[instance->material];
      // what is clear or a mirror is overwritten by what is seen in it, where the path does not end first
      color = material_scatters(point_material(m, 1.0f))
                  ? scattered_color(scene, instance, m, s, triangle, h.y, h.z)
                  : (float3)(0.0f);
    }
  }
  feature_color[slot] = (float4)(color * clamp(carried.xyz, 0.0f, 1.0f), 0);
  feature_normal[slot] = (float4)(normal, 0);
}

// guide_color, guide_normal: [height x width] sums over the samples, in their order, as accumulate.cl
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
