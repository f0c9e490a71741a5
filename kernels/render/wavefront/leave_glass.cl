// What render/leave_glass.cl does, one path a work-item. Groups are small, as one path may meet a hundred times the faces
// that another does.
#define PVG_INLINE_ALL
#include "shared/pocl.h"

#include "render/leave_glass.cl"

// as in render/wavefront/shade.cl;  depth: bounces so far
kernel __attribute__((reqd_work_group_size(16, 1, 1))) void leave_glass(
    const uint n, const uint depth, const uint notes_features, global uint* restrict queue,
    global uint2* restrict stream, global const float8* restrict top, global const float8* restrict nodes,
    global const float4* restrict blocks, global const Instance* restrict instances,
    global const Material* restrict materials, global const TextureInfo* restrict textures,
    global const uchar4* restrict texels, constant float* restrict decode, global const uint* restrict triangles,
    global const Vertex* restrict vertices, global const float* restrict colors,
    global const float* restrict second_uvs, global float4* restrict origin, global float4* restrict direction,
    global float4* restrict throughput, global float4* restrict feature_color) {
  const uint i = get_global_id(0);
  if (i >= n) return;
  const Trees trees = {top, nodes, blocks, instances};
  const Shading scene = {instances, materials, textures,   texels, decode, triangles, vertices,
                         colors,    second_uvs, 0,      0,      0,         0};
  const Slots slots = {queue, 0, stream, origin, direction, throughput, 0, 0, 0, 0, 0, 0, feature_color, 0};
  leave_glass_of_path(trees, scene, depth, notes_features, queue[i], slots);
}
