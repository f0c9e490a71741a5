// What may happen to sixteen paths side by side where they hit, one function per case: a shadow receiver, a surface that
// scatters, clear glass. What each does, and its formula: receiver.cl and interact.cl, which this equals up to rounding.
#ifndef PVG_RENDER_LANES_INTERACT_CL
#define PVG_RENDER_LANES_INTERACT_CL
#include "render/noted.cl"
#include "render/receiver.cl"
#include "render/lanes/shadow.cl"
#include "render/slots.cl"
#include "render/lanes/scatter.cl"

typedef struct {
  uint depth, notes_features;
  uint keeps_shadow_rays;  // they are written and asked later, as cut-out surfaces dim them
  const Trees* trees;
} Bounce;

// throughput after the absorption on the way to the surface
static inline Packet transmitted(const Shading scene, const Paths* p, const Surfaces* s) {
  if (!mask16(p->media != 0u)) return p->throughput;
  uint media[PACKET], current[PACKET];
  vstore16(p->media, 0, media);
  for (uint k = 0; k < PACKET; ++k) {
    const uint material = media_current(media[k], scene.materials);
    current[k] = material ? material - 1 : 0;  // any will do for the lanes in air
  }
  const Packet absorption = vectors_of(load_rows((global const float4*)scene.materials, current, ROWS_OF(Material), 2));
  const int16 absorbs = (p->media != 0u) & ((absorption.x != 0.0f) | (absorption.y != 0.0f) | (absorption.z != 0.0f));
  if (!mask16(absorbs)) return p->throughput;
  const float16 distance = p->t + ray_offsets(s->point);
  const Packet share = {exp(-distance * absorption.x), exp(-distance * absorption.y), exp(-distance * absorption.z)};
  return chosen(absorbs, products(p->throughput, share), p->throughput);
}

static inline Packet clamped_colors(const Packet c) {
  const Packet p = {clamped(c.x), clamped(c.y), clamped(c.z)};
  return p;
}

// the normal or its opposite, so that it looks to where the path comes from
static inline Packet toward_paths(const Packet normal, const Packet direction) {
  return chosen(dots(normal, direction) < 0.0f, normal, negated(normal));
}

// note_surface(), write_note() and weigh_note() of the paths that nothing has scattered yet;  color: 0 of what does not
// scatter;  likelihood: as in Path
static inline void write_notes(const Bounce bounce, const Paths* p, const Surfaces* s, const Packet color,
                               const float16 likelihood, const Slots slots) {
  const uint wanted = mask16((p->flags & PATH_SCATTERED) == 0u);
  if (!bounce.notes_features || !wanted) return;
  const float16 before = bounce.depth > 0 ? load_rows(slots.feature_color, p->slot, 1, 0).w : sixteen(1.0f);
  const float16 weight = likelihood < 1.0f ? largest(before * likelihood, sixteen(LEAST_NOTE)) : before;
  const Packet shown = products(clamped_colors(color), clamped_colors(p->throughput));
  const Packet normal = toward_paths(s->shading, p->direction);
  store_rows_where(wanted, rows_of(shown, weight), slots.feature_color, p->slot);
  store_rows_where(wanted, rows_of(normal, sixteen(0.0f)), slots.feature_normal, p->slot);
}

// alive: bits of those that go on
static inline void write_alive(const Paths* p, const uint alive, const Slots slots) {
  for (uint k = 0; k < PACKET; ++k) slots.alive[p->place[k]] = alive >> k & 1u;
}

// those of the lanes with is_lit; kind SHADOW_NONE for the others
static inline void write_shadow_rays(const Paths* p, const int16 is_lit, const uint16 kind, const Packet origin,
                                     const Packet to_light, const Packet light, const float16 weight,
                                     const Slots slots) {
  const uint16 kinds = is_lit ? kind : (uint16)(SHADOW_NONE);
  store_rows(rows_of(origin, as_float16(kinds)), slots.shadow_origin, p->slot);
  if (!mask16(is_lit)) return;
  store_rows(rows_of(to_light, sixteen(0.0f)), slots.shadow_direction, p->slot);
  store_rows(rows_of(light, weight), slots.shadow_light, p->slot);
}

// adds what arrives of the light of the lanes with is_lit, or keeps it for later;  kind: SHADOW_...
static inline void send_shadow_rays(const Launch launch, const Shading scene, const Bounce bounce, const Paths* p,
                                    const int16 is_lit, const uint16 kind, const Packet origin, const Packet to_light,
                                    const Packet light, const float16 weight, const Slots slots) {
  if (bounce.keeps_shadow_rays) {
    write_shadow_rays(p, is_lit, kind, origin, to_light, light, weight, slots);
    return;
  }
  const uint lit = mask16(is_lit) & p->lanes;
  if (!lit) return;
  Lanes rays;
  store_packet(origin, rays.origin);
  store_packet(to_light, rays.direction);
  const uint receivers = lit & mask16(kind == SHADOW_RECEIVER);
  const Asked asked = {lit & ~receivers, receivers,
                       (lit & mask16(kind == SHADOW_SURFACE_GLASS)) | (launch.transparent_shadows ? receivers : 0u)};
  Packet share;
  find_arriving(bounce.trees, scene.materials, &rays, &asked, weight, &share);
  const Rows before = load_rows(slots.radiance, p->slot, 1, 0);
  store_rows_where(lit, rows_of(plus(vectors_of(before), products(light, share)), before.w), slots.radiance, p->slot);
}

// meet_receiver() where the environment is none of the lights
static inline void shade_receiver_group(const Launch launch, const Shading scene, const Bounce bounce,
                                        const Paths* p, const Surfaces* s, const Slots slots) {
  global const float4* materials = (global const float4*)scene.materials;
  const uint stride = ROWS_OF(Material);
  const Rows kind = load_rows(materials, p->material, stride, 0), own = load_rows(materials, p->material, stride, 1);
  const Packet color = surface_colors(scene, s, as_int16(kind.y), vectors_of(own));
  write_notes(bounce, p, s, color, sixteen(1.0f), slots);
  const Chances chance = draw_chances(slots.stream, p, bounce.depth);
  const float16 strength = own.w, ambient = load_rows(materials, p->material, stride, 4).w;
  const Packet shown = times(products(transmitted(scene, p, s), color), sixteen(launch.receiver_scale));
  const Packet shaded = times(shown, strength);
  const Packet normal = toward_paths(s->face, p->direction);
  const Packet origin = leave_surfaces(s->point, normal);

  const Packet even = times(to_worlds(make_frames(normal), cosine_directions(chance.material_x, chance.material_y)),
                            sixteen(FAR_AWAY));
  const int16 is_even = chance.roulette < ambient;
  Packet to_light = even;
  int16 has_shadow = is_even;
  if (launch.n_lights > 0) {
    const LightSamples sample = sample_lights(launch, scene, origin, &chance);
    to_light = chosen(is_even, even, sample.to_light);
    has_shadow |= (sample.pdf > 0.0f) & (dots(normal, sample.to_light) > 0.0f);
  }
  has_shadow &= strength != 0.0f;
  const Rows before = load_rows(slots.radiance, p->slot, 1, 0);
  const Packet lit = times(shown, 1.0f - strength);
  const Packet radiance = plus(vectors_of(before), chosen(has_shadow, lit, plus(lit, shaded)));
  store_rows(rows_of(radiance, before.w), slots.radiance, p->slot);
  send_shadow_rays(launch, scene, bounce, p, has_shadow, (uint16)(SHADOW_RECEIVER), origin, to_light, shaded,
                   sixteen(1.0f), slots);
  write_alive(p, 0, slots);
}

// roulette();  flags: after the surface;  returned: is alive
static inline int16 roulettes(const uint depth, const float16 u, const uint16 flags, Packet* throughput) {
  const float16 most = largest(throughput->x, largest(throughput->y, throughput->z));
  const int16 carries = most > 0.0f;
  if (depth < 2) return carries;
  const float16 enough = (flags & PATH_SCATTERED) != 0u ? sixteen(1.0f) : sixteen(0.25f);
  const float16 survival = most >= enough ? sixteen(1.0f) : largest(most / enough, sixteen(0.05f));
  *throughput = times(*throughput, 1.0f / survival);
  return carries & ((most >= enough) | (u < survival));
}

static inline float16 light_cosines(const Surfaces* s, const Packet direction) {
  return largest(sixteen(1e-6f), fabs(dots(s->face, direction)));
}

static inline float16 camera_densities(const Launch launch, const Surfaces* s) {
  const PinholeCamera c = launch.camera;
  const Packet seen = minus(s->point, packet_of((float3)(c.to_world[3], c.to_world[7], c.to_world[11])));
  const float16 d2 = dots(seen, seen), d = sqrt(d2);
  const float16 cosine = fabs(dots(s->face, seen)) / d;
  if (c.model == CAMERA_PINHOLE && !c.is_distorted) {
    const float16 z = dots(packet_of((float3)(c.to_world[2], c.to_world[6], c.to_world[10])), seen) / d;
    return c.fx * c.fy / (z * z * z) * cosine / d2;
  }
  float point[3][PACKET], face[3][PACKET], density[PACKET];
  store_packet(s->point, point);
  store_packet(s->face, face);
  for (uint k = 0; k < PACKET; ++k) {
    Surface one;
    one.point = (float3)(point[0][k], point[1][k], point[2][k]);
    one.face = (float3)(face[0][k], face[1][k], face[2][k]);
    density[k] = camera_density(launch, one);
  }
  return vload16(0, density);
}

// face and shading normal, toward the path
typedef struct {
  Packet face, normal;
} Sides;

static inline Sides sides_of(const Surfaces* s, const Packet direction) {
  Sides n;
  n.face = toward_paths(s->face, direction);
  n.normal = chosen(dots(s->shading, n.face) > 0.0f, s->shading, negated(s->shading));
  n.normal = chosen(dots(n.normal, direction) >= 0.0f, n.face, n.normal);
  return n;
}

static inline void write_paths(const Paths* p, const Packet origin, const float16 pdf, const Packet direction,
                               const uint16 media, const Packet throughput, const uint16 flags, const Slots slots) {
  store_rows(rows_of(origin, pdf), slots.origin, p->slot);
  store_rows(rows_of(direction, as_float16(media)), slots.direction, p->slot);
  store_rows(rows_of(throughput, as_float16(flags)), slots.throughput, p->slot);
}

// light_surface(), scatter() and note_scattered();  kind: of all, known when this is compiled
static inline void shade_scattering_group(const Launch launch, const Shading scene, const Bounce bounce,
                                          const uint kind, const Paths* p, const Surfaces* s,
                                          const Slots slots) {
  global const float4* materials = (global const float4*)scene.materials;
  const uint stride = ROWS_OF(Material);
  const Rows first = load_rows(materials, p->material, stride, 0), second = load_rows(materials, p->material, stride, 1);
  PointMaterials m = {kind, surface_colors(scene, s, as_int16(first.y), vectors_of(second)), {0.0f, 0.0f, 0.0f},
                      first.z, 0.0f, first.w};
  int16 is_matte = (int16)(-1);
  if (kind == MATERIAL_CONDUCTOR) {
    m.own_color = vectors_of(load_rows(materials, p->material, stride, 4));
    is_matte = (int16)(0);
  }
  if (kind == MATERIAL_METALLIC_ROUGHNESS) {
    m.metallic = load_rows(materials, p->material, stride, 2).w;
    is_matte = m.metallic < 0.5f;
  }
  write_notes(bounce, p, s, m.color, sixteen(1.0f), slots);
  const Chances chance = draw_chances(slots.stream, p, bounce.depth);
  const Packet carried = transmitted(scene, p, s);
  const Sides side = sides_of(s, p->direction);
  const Frames frame = make_frames(side.normal);
  const Packet wo = to_locals(frame, negated(p->direction));

  int16 is_lit = (int16)(0);
  const Packet above = leave_surfaces(s->point, side.face);
  Packet to_light = above, light = above;
  float16 weight = 0.0f;
  if (launch.n_lights > 0) {
    const LightSamples sample = sample_lights(launch, scene, s->point, &chance);
    const Packet wi = to_locals(frame, units(sample.to_light));
    const Packet f = materials_eval(m, wo, wi);
    is_lit = (sample.pdf > 0.0f) & (dots(side.face, sample.to_light) > 0.0f) & (wi.z > 0.0f) & (f.x + f.y + f.z > 0.0f);
    to_light = minus(sample.to_light, minus(above, s->point));
    light = times(products(products(carried, f), sample.radiance), 1.0f / sample.pdf);
    const float16 a = sample.pdf * sample.pdf, other = materials_pdf(m, wo, wi);
    weight = a / (a + other * other);
  }
  const uint16 through = is_matte & (launch.transparent_shadows ? -1 : 0) ? (uint16)(SHADOW_SURFACE_GLASS)
                                                                          : (uint16)(SHADOW_SURFACE);
  send_shadow_rays(launch, scene, bounce, p, is_lit, through, above, to_light, light, weight, slots);

  const MaterialSamples sample = materials_sample(m, wo, &chance);
  const Packet direction = to_worlds(frame, sample.direction);
  Packet throughput = products(carried, sample.weight);
  uint16 flags = (p->flags & PATH_SEEN) | PATH_SCATTERED;
  flags = is_matte ? flags | PATH_DIFFUSE : flags;
  if (launch.n_light_paths > 0) {  // note_scattered()
    float16 density;
    if (bounce.depth == 0) {
      flags |= PATH_SEEN;
      density = camera_densities(launch, s) * sample.pdf / light_cosines(s, direction);
    } else {
      float before[PACKET];
      for (uint k = 0; k < PACKET; ++k) before[k] = slots.radiance[p->slot[k]].w;
      const float16 other = materials_pdf(m, sample.direction, wo);
      density = vload16(0, before) *
                (sample.pdf * light_cosines(s, p->direction) / (other * light_cosines(s, direction)));
    }
    density = least(density, sixteen(MOST_DENSITY));
    float after[PACKET];
    vstore16(density, 0, after);
    for (uint k = 0; k < PACKET; ++k) slots.radiance[p->slot[k]].w = after[k];
  }
  const int16 stays = dots(direction, side.face) >= 0.0f;
  const uint alive = mask16(stays & roulettes(bounce.depth, chance.roulette, flags, &throughput));
  write_paths(p, above, sample.pdf, direction, p->media, throughput, flags, slots);
  write_alive(p, alive, slots);
}

typedef struct {
  Packet direction;  // local
  int16 is_refracted;
  float16 chance;  // of what it did
} GlassSamples;

// dielectric_sample() of solids
static inline GlassSamples sample_glass(const Packet wo, const float16 eta, const float16 choice) {
  const float16 reflectance = fresnel_dielectrics(wo.z, eta);
  GlassSamples g;
  g.is_refracted = choice >= reflectance;
  g.chance = g.is_refracted ? 1.0f - reflectance : reflectance;
  const float16 across2 = (wo.x * wo.x + wo.y * wo.y) / (eta * eta), scale = g.is_refracted ? 1.0f / eta : sixteen(1.0f);
  g.direction.x = -wo.x * scale;
  g.direction.y = -wo.y * scale;
  g.direction.z = g.is_refracted ? -sqrt(largest(sixteen(0.0f), 1.0f - across2)) : wo.z;
  return g;
}

// pass_glass() and pass_hidden()
static inline void shade_glass_group(const Shading scene, const Bounce bounce, const Paths* p, const Surfaces* s,
                                     const Slots slots) {
  const Packet nothing = {0.0f, 0.0f, 0.0f};
  Chances chance;
  uint16 key, sample_number;
  draw_choices(slots.stream, p, bounce.depth, &key, &sample_number, &chance);
  Packet throughput = transmitted(scene, p, s);
  const Sides side = sides_of(s, p->direction);

  uint media[PACKET], inner[PACKET], hidden[PACKET];
  float etas[PACKET];
  const uint enters = mask16(dots(s->face, p->direction) < 0.0f);
  vstore16(p->media, 0, media);
  for (uint k = 0; k < PACKET; ++k) {
    const Boundary b = boundary_of(media[k], p->material[k], scene.materials, enters >> k & 1u);
    etas[k] = b.eta;
    inner[k] = b.inner;
    hidden[k] = b.is_hidden ? 0xffffffffu : 0u;
  }
  const int16 is_hidden = as_int16(vload16(0, hidden));
  const float16 eta = vload16(0, etas);

  const Packet back = negated(p->direction);
  const Frames frame = make_frames(side.normal);
  GlassSamples sample = sample_glass(to_locals(frame, back), eta, chance.material_choice);
  Packet direction = to_worlds(frame, sample.direction);
  const float16 likelihood = least(sixteen(1.0f), sample.chance / (1.0f - sample.chance));
  write_notes(bounce, p, s, nothing, is_hidden ? sixteen(1.0f) : likelihood, slots);
  // on the wrong side of the true surface: once more with the true normal, same choice
  const int16 is_wrong = (dots(direction, side.face) < 0.0f) != (sample.is_refracted != 0);
  if (mask16(is_wrong)) {
    const Frames flat = make_frames(side.face);
    const float16 choice = sample.is_refracted ? sixteen(0x1.fffffep-1f) : sixteen(0.0f);
    const GlassSamples again = sample_glass(to_locals(flat, back), eta, choice);
    direction = chosen(is_wrong, to_worlds(flat, again.direction), direction);
    sample.is_refracted = is_wrong ? again.is_refracted : sample.is_refracted;
  }
  const int16 passes = is_hidden | (dots(direction, side.face) < 0.0f);
  const Packet color = vectors_of(load_rows((global const float4*)scene.materials, p->material, ROWS_OF(Material), 1));
  throughput = chosen(sample.is_refracted & ~is_hidden, products(throughput, color), throughput);
  direction = chosen(is_hidden, p->direction, units(direction));
  const Packet origin = leave_surfaces(s->point, chosen(passes, negated(side.face), side.face));
  const uint16 flags = passes ? p->flags | PATH_REFRACTED : p->flags;
  const uint16 behind = passes ? vload16(0, inner) : p->media;
  const uint alive = mask16(roulettes(bounce.depth, chance.roulette, flags, &throughput));
  write_paths(p, origin, sixteen(0.0f), direction, behind, throughput, flags, slots);
  if (bounce.keeps_shadow_rays)
    write_shadow_rays(p, (int16)(0), (uint16)(SHADOW_NONE), nothing, nothing, nothing, sixteen(0.0f), slots);
  write_alive(p, alive, slots);
}
#endif
