// What render/holes.cl does, one path a work-item.
#include "render/holes.cl"

// as in intersect.cl and shade.cl beside this;  depth: bounces so far
kernel void pass_holes(const uint n, const uint depth, global uint* restrict queue,
                       global uint2* restrict stream, global const float8* restrict top,
                       global const float8* restrict nodes, global const float4* restrict blocks,
                       global const Instance* restrict instances,
                       global const Material* restrict materials, global const TextureInfo* restrict textures,
                       global const uchar4* restrict texels, global const uint* restrict triangles,
                       global const Vertex* restrict vertices, global const float* restrict second_uvs,
                       global float4* restrict origin, global float4* restrict direction,
                       global float4* restrict hit, global uint* restrict hit_instance) {
  const uint i = get_global_id(0);
  if (i >= n) return;
  const Trees trees = {top, nodes, blocks, instances};
  const Cutouts cutouts = {instances, materials, textures, texels, triangles, vertices, second_uvs};
  const Slots slots = {queue, 0, stream, origin, direction, 0, 0, hit, hit_instance, 0, 0, 0, 0, 0};
  pass_holes_of_path(trees, cutouts, depth, queue[i], slots);
}

// shadow_...: as in shade_path.cl; a ray through which nothing comes is taken away
kernel void shadow_holes(const uint n, global uint* restrict queue, global const float8* restrict top,
                         global const float8* restrict nodes, global const float4* restrict blocks,
                         global const Instance* restrict instances, global const Material* restrict materials,
                         global const TextureInfo* restrict textures, global const uchar4* restrict texels,
                         global const uint* restrict triangles, global const Vertex* restrict vertices,
                         global const float* restrict second_uvs, global float4* restrict shadow_origin,
                         global float4* restrict shadow_direction,
                         global float4* restrict shadow_light) {
  const uint i = get_global_id(0);
  if (i >= n) return;
  const Trees trees = {top, nodes, blocks, instances};
  const Cutouts cutouts = {instances, materials, textures, texels, triangles, vertices, second_uvs};
  const Slots slots = {queue, 0, 0, 0, 0, 0, 0, 0, 0, shadow_origin, shadow_direction, shadow_light, 0, 0};
  dim_shadow_ray(trees, cutouts, queue[i], slots);
}
