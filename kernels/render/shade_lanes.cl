// Stage 3 on a CPU, of the surfaces that most paths meet, sixteen paths of one kind of surface at once: shadow receivers,
// diffuse and coated surfaces, rough metals and clear glass, without normal maps and without light of their own. What
// happens to each: interact_lanes.cl. shade.cl, which runs next, takes all others.
#define PVG_INLINE_ALL
#include "shared/pocl.h"

#include "render/interact_lanes.cl"

// kinds of surfaces; OTHERS: left to shade.cl
enum { RECEIVERS, DIFFUSE, METALS, COATED, GLASS, OTHERS, N_GROUPS };

// the places in the queue whose paths meet a surface of each kind
typedef struct {
  uint n[N_GROUPS];
  uint place[N_GROUPS][SHADE_CHUNK];
} Groups;

// whose surfaces an instance shows
static inline uint group_of(const int environment_light, global const Instance* instance, global const Material* m) {
  const uint flags = m->flags, kind = m->kind;
  const uint is_plain = (instance->visual != 0) & !(instance->flags & (INSTANCE_COLORS | INSTANCE_SECOND_UVS)) &
                        !(flags & MATERIAL_EMITS) & (m->normal_texture < 0);
  const uint is_receiver = (kind == MATERIAL_SHADOW_RECEIVER) & (environment_light < 0);
  const uint is_glass = (kind == MATERIAL_DIELECTRIC) & ((flags & MATERIAL_HAS_INSIDE) != 0) & (m->texture < 0);
  const uint is_opaque = (m->metallic_roughness_texture < 0) & (m->transmission == 0) &
                         !(flags & (MATERIAL_HAS_INSIDE | MATERIAL_THIN));
  uint group = OTHERS;
  group = is_receiver ? RECEIVERS : group;
  group = kind == MATERIAL_DIFFUSE ? DIFFUSE : group;
  group = ((kind == MATERIAL_CONDUCTOR) & is_opaque & (m->alpha >= MIRROR_ALPHA)) ? METALS : group;
  group = (kind == MATERIAL_METALLIC_ROUGHNESS) & is_opaque ? COATED : group;
  group = is_glass ? GLASS : group;
  return is_plain ? group : OTHERS;
}

// Without branches, which neighbours in the queue that meet different kinds would make hard to foresee. n_shaded: groups
// from there on are others
static inline void sort_into_groups(const uint n_shaded, global const uchar* group_of_instance, const uint first,
                                    const uint last, global const uint* queue, global const float4* hit,
                                    global const uint* hit_instance, global uint* alive, Groups* groups) {
  for (uint i = first; i < last; ++i) {
    const uint slot = queue[i], triangle = as_uint(hit[slot].w), met = group_of_instance[hit_instance[slot]];
    const uint group = (triangle == NO_TRIANGLE) | (met >= n_shaded) ? (uint)OTHERS : met;
    groups->place[group][groups->n[group]++] = i;
    alive[i] = LEFT_TO_SHADE;
  }
}

// The paths number first .. first + 15 of a group. Where it has fewer its last path fills the other lanes, which write what
// it writes: each buffer is read for all lanes before one of them writes there.
static inline void load_paths(const Groups* groups, const uint group, const uint first, const Shading scene,
                              global const uint* queue, const Slots slots, global const uint* hit_instance, Paths* p) {
  for (uint k = 0; k < PACKET; ++k) {
    p->place[k] = groups->place[group][min(first + k, groups->n[group] - 1)];
    p->slot[k] = queue[p->place[k]];
    p->instance[k] = hit_instance[p->slot[k]];
    p->material[k] = scene.instances[p->instance[k]].material;
  }
  const Rows h = load_rows(slots.hit, p->slot, 1, 0), d = load_rows(slots.direction, p->slot, 1, 0),
             t = load_rows(slots.throughput, p->slot, 1, 0);
  p->t = h.x;
  p->u = h.y;
  p->v = h.z;
  vstore16(as_uint16(h.w), 0, p->triangle);
  p->direction = vectors_of(d);
  p->media = as_uint16(d.w);
  p->throughput = vectors_of(t);
  p->flags = as_uint16(t.w);
}

// The places first .. first + SHADE_CHUNK - 1 of the queue. A function of its own, as PoCL compiles what stands in a
// kernel three times.
TREE_FUNCTION void shade_chunk(const uint n, const uint first, const Launch* launch, const Shading* scene,
                               const Bounce bounce, global const uchar* group_of_instance, global const uint* queue,
                               global const uint2* stream, global const uint* hit_instance, const Slots* slots) {
  Groups groups;
  for (uint g = 0; g < N_GROUPS; ++g) groups.n[g] = 0;
  const uint end = bounce.depth >= launch->max_depth ? RECEIVERS + 1 : OTHERS;  // all others end there
  sort_into_groups(end, group_of_instance, first, min(first + SHADE_CHUNK, n), queue, slots->hit, hit_instance,
                   slots->alive, &groups);
  Paths paths;
  for (uint group = RECEIVERS; group < end; ++group)
    for (uint k = 0; k < groups.n[group]; k += PACKET) {
      load_paths(&groups, group, k, *scene, queue, *slots, hit_instance, &paths);
      const Surfaces surfaces = surfaces_at(*scene, &paths);
      if (group == RECEIVERS)
        shade_receiver_group(*launch, *scene, bounce, &paths, &surfaces, stream, *slots);
      else if (group == GLASS)
        shade_glass_group(*scene, bounce, &paths, &surfaces, stream, *slots);
      else if (group == DIFFUSE)
        shade_scattering_group(*launch, *scene, bounce, MATERIAL_DIFFUSE, &paths, &surfaces, stream, *slots);
      else if (group == METALS)
        shade_scattering_group(*launch, *scene, bounce, MATERIAL_CONDUCTOR, &paths, &surfaces, stream, *slots);
      else
        shade_scattering_group(*launch, *scene, bounce, MATERIAL_METALLIC_ROUGHNESS, &paths, &surfaces, stream, *slots);
    }
}

// groups: [n] of the instances
kernel void group_instances(const uint n, const int environment_light, global const Instance* restrict instances,
                            global const Material* restrict materials, global uchar* restrict groups) {
  const uint i = get_global_id(0);
  if (i < n) groups[i] = (uchar)group_of(environment_light, instances + i, materials + instances[i].material);
}

// as in shade.cl, a work-item takes SHADE_CHUNK places of the queue;  alive: LEFT_TO_SHADE of those that it left
kernel __attribute__((reqd_work_group_size(1, 1, 1))) void shade_lanes(
    const uint n, const Launch launch, const uint depth, const uint notes_features,
    global const uchar* restrict group_of_instance, global const uint* restrict queue,
    global const uint2* restrict stream, global const Instance* restrict instances,
    global const Material* restrict materials, global const TextureInfo* restrict textures,
    global const uchar4* restrict texels, constant float* restrict decode, global const uint* restrict triangles,
    global const Vertex* restrict vertices, global const float* restrict second_uvs, global const Light* restrict lights,
    global const float* restrict environment, global const EnvironmentCell* restrict cells, global const float4* restrict hit,
    global const uint* restrict hit_instance, global float4* restrict origin, global float4* restrict direction,
    global float4* restrict throughput, global float4* restrict radiance, global float4* restrict shadow_origin,
    global float4* restrict shadow_direction, global float4* restrict shadow_light, global uint* restrict alive,
    global float4* restrict feature_color, global float4* restrict feature_normal) {
  const uint first = get_global_id(0) * SHADE_CHUNK;
  if (first >= n) return;
  const Shading scene = {instances, materials, textures,   texels, decode,      triangles, vertices,
                         0,         second_uvs, lights,    environment, cells,  0};
  const Slots slots = {hit,           origin,           direction,    throughput, radiance,      shadow_origin,
                       shadow_direction, shadow_light, alive,      feature_color, feature_normal};
  const Bounce bounce = {depth, notes_features};
  shade_chunk(n, first, &launch, &scene, bounce, group_of_instance, queue, stream, hit_instance, &slots);
}
