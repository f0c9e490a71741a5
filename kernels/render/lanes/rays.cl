// Rays of a queue on a CPU, for what asks for them alone (paths from lamps, benchmarks): what
// render/wavefront/intersect.cl and render/wavefront/shadow.cl do, RAYS_CHUNK of them a work-item.
#include "render/lanes/closest.cl"
#include "render/lanes/shadow.cl"

// arguments as in render/wavefront/intersect.cl
kernel __attribute__((reqd_work_group_size(1, 1, 1))) void intersect_lanes(
    const uint n, global uint* restrict queue, global const float8* restrict top, global const float8* restrict nodes,
    global const float4* restrict blocks, global const Instance* restrict instances,
    global const float4* restrict origin, global const float4* restrict direction, global float4* restrict hit,
    global uint* restrict hit_instance) {
  const uint first = get_global_id(0) * RAYS_CHUNK;
  const Trees trees = {top, nodes, blocks, instances};
  if (first < n)
    find_closest_of_queue(trees, min(n - first, (uint)RAYS_CHUNK), queue + first, origin, direction, hit, hit_instance);
}

// arguments as in render/wavefront/shadow.cl
kernel __attribute__((reqd_work_group_size(1, 1, 1))) void shadow_lanes(
    const uint n, global uint* restrict queue, const uint transparent_shadows, global const float8* restrict top,
    global const float8* restrict nodes, global const float4* restrict blocks,
    global const Instance* restrict instances, global const Material* restrict materials,
    global float4* restrict shadow_origin, global float4* restrict shadow_direction,
    global float4* restrict shadow_light, global float4* restrict radiance) {
  const uint first = get_global_id(0) * RAYS_CHUNK;
  const Trees trees = {top, nodes, blocks, instances};
  const Slots slots = {queue + first, 0, 0, 0, 0, 0, radiance, 0, 0, shadow_origin, shadow_direction, shadow_light, 0, 0};
  ushort places[RAYS_CHUNK];
  for (uint i = 0; i < RAYS_CHUNK; ++i) places[i] = (ushort)i;
  if (first < n)
    add_light_of_places(trees, materials, transparent_shadows, places, min(n - first, (uint)RAYS_CHUNK), &slots);
}
