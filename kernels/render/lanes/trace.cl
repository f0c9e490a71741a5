// All stages of the paths of a launch on a CPU: a work-item takes TRACE_CHUNK paths through all bounces, so that their
// state stays in the cache of its core, and no core waits for another one after each stage. Then it takes the next ones
// that nobody has into the same slots: some chunks take ten times as long as others. On a GPU each stage is a kernel of
// its own (wavefront/).
#define PVG_INLINE_ALL
#include "shared/pocl.h"

#include "render/holes.cl"
#include "render/lanes/closest.cl"
#include "render/lanes/shade.cl"
#include "render/lanes/shadow.cl"
#include "render/lanes/start.cl"
#include "render/leave_glass.cl"

// which stages a picture needs
typedef struct {
  uint notes_features, has_cutouts;  // 0 or 1
  uint first_leaves_glass;           // the bounce from which on leave_glass.cl runs; beyond max_depth: never
} Tracing;

// what few scenes need: functions of their own, so that trace_chunk() stays small
OUT_OF_LINE void leave_glass_of_queue(const Trees* trees, const Shading* scene, const Bounce bounce, const uint n,
                                      const Slots* slots) {
  for (uint i = 0; i < n; ++i)
    leave_glass_of_path(*trees, *scene, bounce.depth, bounce.notes_features, slots->queue[i], *slots);
}
OUT_OF_LINE void pass_holes_of_queue(const Trees* trees, const Cutouts* cutouts, const uint depth, const uint n,
                                     const Slots* slots) {
  for (uint i = 0; i < n; ++i) pass_holes_of_path(*trees, *cutouts, depth, slots->queue[i], *slots);
}
OUT_OF_LINE void add_dimmed_light(const Launch* launch, const Trees* trees, const Cutouts* cutouts, const uint n,
                                  const Slots* slots) {
  ushort places[TRACE_CHUNK];
  for (uint i = 0; i < n; ++i) {
    places[i] = (ushort)i;
    dim_shadow_ray(*trees, *cutouts, slots->queue[i], *slots);
  }
  add_light_of_places(*trees, cutouts->materials, launch->transparent_shadows, places, n, slots);
}

// slots of the paths that go on, in order; returned: how many
static inline uint keep_alive(const uint n, const Slots* slots) {
  uint kept = 0;
  for (uint i = 0; i < n; ++i) {
    slots->queue[kept] = slots->queue[i];
    kept += slots->alive[i];
  }
  return kept;
}

// the n paths in the first slots, which have started; returned: the number of segments
OUT_OF_LINE uint trace_chunk(const Launch* launch, const Trees* trees, const Shading* scene, const Tracing tracing,
                             global const uchar* group_of_instance, uint n, const Slots* slots) {
  const Cutouts cutouts = cutouts_of(*scene);
  uint segments = 0;
  for (uint depth = 0; depth <= launch->max_depth && n > 0; ++depth) {
    const Bounce bounce = {depth, tracing.notes_features, tracing.has_cutouts, trees};
    segments += n;
    if (depth >= tracing.first_leaves_glass) leave_glass_of_queue(trees, scene, bounce, n, slots);
    if (depth == 0)
      find_closest_of_neighbours(*trees, n, slots->origin, slots->direction, slots->hit, slots->hit_instance);
    else
      find_closest_of_queue(*trees, n, slots->queue, slots->origin, slots->direction, slots->hit, slots->hit_instance);
    if (tracing.has_cutouts) pass_holes_of_queue(trees, &cutouts, depth, n, slots);
    shade_queue(launch, scene, bounce, group_of_instance, n, slots);
    if (tracing.has_cutouts) add_dimmed_light(launch, trees, &cutouts, n, slots);
    n = keep_alive(n, slots);
  }
  return segments;
}

// groups: [n], which surfaces each of the n instances has (shade.cl)
kernel void group_instances(const uint n, const int environment_light, global const Instance* restrict instances,
                            global const Material* restrict materials, global uchar* restrict groups) {
  const uint i = get_global_id(0);
  if (i < n) groups[i] = (uchar)group_of(environment_light, instances + i, materials + instances[i].material);
}

// n: paths;  pixels: as in render/wavefront/generate.cl;  group_of_instance: [instances] from group_instances;
// next: [1] the first chunk that nobody has, 0 at first;  segments: [chunks] traced, written here;  radiance,
// feature_...: [n], the features one element that nobody reads where notes_features is 0;  the others as in
// render/wavefront/shade.cl, TRACE_CHUNK slots for each work-item
kernel __attribute__((reqd_work_group_size(1, 1, 1))) void trace(
    const uint n, const Launch launch, const uint notes_features, const uint has_cutouts, const uint first_leaves_glass,
    global const uint* restrict pixels, global const uchar* restrict group_of_instance, global uint* restrict queue,
    global uint2* restrict stream, global const float8* restrict top, global const float8* restrict nodes,
    global const float4* restrict blocks, global const Instance* restrict instances,
    global const Material* restrict materials,
    global const TextureInfo* restrict textures, global const uchar4* restrict texels, constant float* restrict decode,
    global const uint* restrict triangles, global const Vertex* restrict vertices, global const float* restrict colors,
    global const float* restrict second_uvs, global const Light* restrict lights,
    global const float* restrict environment, global const EnvironmentCell* restrict cells,
    global const float4* restrict targets, global float4* restrict hit, global uint* restrict hit_instance,
    global float4* restrict origin, global float4* restrict direction, global float4* restrict throughput,
    global float4* restrict radiance, global float4* restrict shadow_origin, global float4* restrict shadow_direction,
    global float4* restrict shadow_light, global uint* restrict alive, global float4* restrict feature_color,
    global float4* restrict feature_normal, volatile global uint* restrict next, global uint* restrict segments) {
  const Trees trees = {top, nodes, blocks, instances};
  const Shading scene = {instances, materials, textures,   texels, decode,      triangles,
                         vertices,  colors,    second_uvs, lights, environment, cells,       targets};
  const Tracing tracing = {notes_features, has_cutouts, first_leaves_glass};
  const size_t own = get_global_id(0) * TRACE_CHUNK;  // its first slot
  for (;;) {
    const uint chunk = atomic_inc(next), first = chunk * TRACE_CHUNK;
    if (first >= n) return;
    const uint n_here = min(n - first, (uint)TRACE_CHUNK);
    const Slots slots = {queue + own, alive + own, stream + own, origin + own, direction + own, throughput + own,
                         radiance + first, hit + own, hit_instance + own, shadow_origin + own, shadow_direction + own,
                         shadow_light + own, feature_color + first, feature_normal + first};
    start_chunk(&launch, pixels, first, n_here, n, &slots);
    segments[chunk] = trace_chunk(&launch, &trees, &scene, tracing, group_of_instance, n_here, &slots);
  }
}
