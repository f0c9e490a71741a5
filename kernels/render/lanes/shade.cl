// Stage 3 on a CPU: sixteen paths of one kind of surface at once, of the kinds that most paths meet: shadow receivers,
// diffuse and coated surfaces, rough metals and clear glass, without normal maps, vertex colours or light of their own. What
// happens to each: render/lanes/interact.cl. The others go one by one: shade_path.cl.
#ifndef PVG_RENDER_LANES_SHADE_CL
#define PVG_RENDER_LANES_SHADE_CL
#include "render/lanes/interact.cl"
#include "render/shade_path.cl"

// kinds of surfaces; OTHERS: all else
enum { RECEIVERS, DIFFUSE, METALS, COATED, GLASS, OTHERS, N_GROUPS };

// the places in the queue whose paths meet a surface of each kind
typedef struct {
  uint n[N_GROUPS];
  ushort place[N_GROUPS][TRACE_CHUNK];
} Groups;

// The group of an instance's surfaces. environment_light: as in Launch;  m: its material
static inline uint group_of(const int environment_light, global const Instance* instance, global const Material* m) {
  const uint flags = m->flags, kind = m->kind;
  const uint is_plain = (instance->visual != 0) & !(instance->flags & (INSTANCE_COLORS | INSTANCE_SECOND_UVS)) &
                        !(flags & MATERIAL_EMITS) & (m->normal_texture < 0);
  const uint is_receiver = (kind == MATERIAL_SHADOW_RECEIVER) & (environment_light < 0);
  const uint is_glass = (kind == MATERIAL_DIELECTRIC) & ((flags & MATERIAL_HAS_INSIDE) != 0) & (m->texture < 0);
  // what transmits has an inside or is thin
  const uint is_opaque = (m->metallic_roughness_texture < 0) & !(flags & (MATERIAL_HAS_INSIDE | MATERIAL_THIN));
  uint group = OTHERS;
  group = is_receiver ? RECEIVERS : group;
  group = kind == MATERIAL_DIFFUSE ? DIFFUSE : group;
  group = ((kind == MATERIAL_CONDUCTOR) & is_opaque & (m->alpha >= MIRROR_ALPHA)) ? METALS : group;
  group = (kind == MATERIAL_METALLIC_ROUGHNESS) & is_opaque ? COATED : group;
  group = is_glass ? GLASS : group;
  return is_plain ? group : OTHERS;
}

// Of n paths, n <= TRACE_CHUNK. n_shaded: groups from this number on count as OTHERS. Without branches, as neighbours in the
// queue meet different kinds and a processor could not foresee them
static inline void sort_into_groups(const uint n_shaded, global const uchar* group_of_instance, const uint n,
                                    const Slots* slots, Groups* groups) {
  for (uint i = 0; i < n; ++i) {
    const uint slot = slots->queue[i], triangle = as_uint(slots->hit[slot].w);
    const uint met = group_of_instance[slots->hit_instance[slot]];
    const uint group = ((triangle == NO_TRIANGLE) | (met >= n_shaded)) ? (uint)OTHERS : met;
    groups->place[group][groups->n[group]++] = (ushort)i;
  }
}

// The paths number first .. first + 15 of a group. Where it has fewer its last path fills the other lanes, which write what
// it writes: each buffer is read for all lanes before one of them writes there.
static inline void load_paths(const Groups* groups, const uint group, const uint first, const Shading scene,
                              const Slots slots, Paths* p) {
  const uint n = min(groups->n[group] - first, (uint)PACKET);
  p->lanes = (1u << n) - 1u;
  for (uint k = 0; k < PACKET; ++k) {
    p->place[k] = groups->place[group][min(first + k, groups->n[group] - 1)];
    p->slot[k] = slots.queue[p->place[k]];
    p->instance[k] = slots.hit_instance[p->slot[k]];
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

// one of the others. A function of its own: PoCL inlines what is called once
OUT_OF_LINE void shade_alone(const Launch* launch, const Shading* scene, const Bounce bounce, const uint place,
                             const Slots* slots) {
  shade_path(*launch, *scene, bounce.depth, bounce.notes_features, place, *slots);
}

// does nothing come from where no surface is?
static inline bool is_dark_outside(const Launch* launch) {
  return launch->environment[0] == 0 && launch->environment[1] == 0 && launch->environment[2] == 0;
}

// n paths in the queue, n <= TRACE_CHUNK
OUT_OF_LINE void shade_queue(const Launch* launch, const Shading* scene, const Bounce bounce,
                             global const uchar* group_of_instance, const uint n, const Slots* slots) {
  Groups groups;
  for (uint g = 0; g < N_GROUPS; ++g) groups.n[g] = 0;
  const uint end = bounce.depth >= launch->max_depth ? RECEIVERS + 1 : OTHERS;  // all others end there
  sort_into_groups(end, group_of_instance, n, slots, &groups);
  Paths paths;
  for (uint group = RECEIVERS; group < end; ++group)
    for (uint k = 0; k < groups.n[group]; k += PACKET) {
      load_paths(&groups, group, k, *scene, *slots, &paths);
      const Surfaces surfaces = surfaces_at(*scene, &paths);
      if (group == RECEIVERS)
        shade_receiver_group(*launch, *scene, bounce, &paths, &surfaces, *slots);
      else if (group == GLASS)
        shade_glass_group(*scene, bounce, &paths, &surfaces, *slots);
      else if (group == DIFFUSE)
        shade_scattering_group(*launch, *scene, bounce, MATERIAL_DIFFUSE, &paths, &surfaces, *slots);
      else if (group == METALS)
        shade_scattering_group(*launch, *scene, bounce, MATERIAL_CONDUCTOR, &paths, &surfaces, *slots);
      else
        shade_scattering_group(*launch, *scene, bounce, MATERIAL_METALLIC_ROUGHNESS, &paths, &surfaces, *slots);
    }
  const bool ends_outside = is_dark_outside(launch) && !bounce.notes_features;
  for (uint k = 0; k < groups.n[OTHERS]; ++k) {
    const uint place = groups.place[OTHERS][k], slot = slots->queue[place];
    if (ends_outside && as_uint(slots->hit[slot].w) == NO_TRIANGLE) {
      slots->alive[place] = 0;
      slots->shadow_origin[slot].w = as_float(SHADOW_NONE);
    } else {
      shade_alone(launch, scene, bounce, place, slots);
    }
  }
  if (!bounce.keeps_shadow_rays)
    add_light_of_places(*bounce.trees, scene->materials, launch->transparent_shadows, groups.place[OTHERS],
                        groups.n[OTHERS], slots);
}
#endif
