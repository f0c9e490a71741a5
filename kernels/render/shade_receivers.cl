// Stage 3 of camera rays that meet a shadow receiver, on a CPU: where sixteen neighbours meet the same triangle they
// are shaded at once. What happens to each, and its formula: receiver.cl, which this equals up to rounding. All others
// are left to shade.cl. The host asks for it where there are few lights, which are tried one by one.
#define PVG_INLINE_ALL
#include "shared/pocl.h"

#include "render/met_surface.cl"
#include "render/noted.cl"
#include "render/packet.cl"
#include "render/receiver.cl"

// The surface and what is the same for the whole packet.
typedef struct {
  Material material;
  Surface surface;   // its point and coordinates are those of one lane
  float3 corner[3];  // in the mesh's frame [m]
  float2 uv[3];
  float3 normal;  // unit, toward the camera
} Receiver;

// the random numbers of a bounce, as in Chance
typedef struct {
  float16 point_x, point_y, choice_x, choice_y, material_x, material_y, roulette;
} PacketChance;

static inline PacketChance draw_packet_chance(const uint16 key, const uint16 sample) {
  PacketChance c;
  float16 unused;
  sample_2d_16(key, sample, 2, &c.point_x, &c.point_y);  // the first bounce: draw_chance()
  sample_2d_16(key, sample, 3, &c.choice_x, &c.choice_y);
  sample_2d_16(key, sample, 4, &c.material_x, &c.material_y);
  sample_2d_16(key, sample, 5, &unused, &c.roulette);
  return c;
}

static inline float16 dot_packet(const float3 a, const Packet b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
static inline float16 between(const float16 u, const float16 v, const float a, const float b, const float c) {
  return (1.0f - u - v) * a + u * b + v * c;
}

// even_direction() [m]
static inline Packet even_directions(const float3 normal, const float16 u, const float16 v) {
  const float16 a = 2 * u - 1, b = 2 * v - 1;
  const int16 is_wide = fabs(a) > fabs(b);
  const float16 r = is_wide ? a : b, x = M_PI_4_F * ((is_wide ? b : a) / r), x2 = x * x;
  const float16 sine = x * (1 - x2 * (1 / 6.0f - x2 * (1 / 120.0f - x2 * (1 / 5040.0f - x2 * (1 / 362880.0f)))));
  const float16 cosine = 1 - x2 * (1 / 2.0f - x2 * (1 / 24.0f - x2 * (1 / 720.0f - x2 * (1 / 40320.0f))));
  const float16 zero = 0.0f;
  const float16 disc_x = r == 0.0f ? zero : r * (is_wide ? cosine : sine);
  const float16 disc_y = r == 0.0f ? zero : r * (is_wide ? sine : cosine);
  const float16 z = sqrt(max((float16)(1e-8f), 1.0f - (disc_x * disc_x + disc_y * disc_y)));
  const Frame f = make_frame(normal);
  const Packet d = {FAR_AWAY * (f.x.x * disc_x + f.y.x * disc_y + f.z.x * z),
                    FAR_AWAY * (f.x.y * disc_x + f.y.y * disc_y + f.z.y * z),
                    FAR_AWAY * (f.x.z * disc_x + f.y.z * disc_y + f.z.z * z)};
  return d;
}

// choose_light(): its index
static inline uint16 chosen_lights(const Launch launch, const Shading scene, const PacketChance chance) {
  const uint16 place = min(convert_uint16(chance.choice_x * (float)launch.n_lights), (uint16)(launch.n_lights - 1));
  uint16 chosen = place;
  for (uint k = 0; k < launch.n_lights; ++k) {
    const int16 takes_other = (place == k) & (chance.choice_y >= scene.lights[k].keep);
    chosen = takes_other ? (uint16)(scene.lights[k].other) : chosen;
  }
  return chosen;
}

// sample_light() of rectangles: toward what V is measured [m]; zero: it cannot shine here. others: bits of the lanes
// that have chosen another kind of light
static inline Packet lamp_directions(const Launch launch, const Shading scene, const Packet origin, const float3 normal,
                                     const PacketChance chance, uint* others) {
  Packet d = {0.0f, 0.0f, 0.0f};
  *others = 0;
  if (launch.n_lights == 0) return d;
  const uint16 chosen = chosen_lights(launch, scene, chance);
  for (uint k = 0; k < launch.n_lights; ++k) {
    global const Light* light = scene.lights + k;
    const int16 is_chosen = chosen == k;
    if (light->kind != LIGHT_RECTANGLE) {
      *others |= mask8(is_chosen.lo) | mask8(is_chosen.hi) << 8;
      continue;
    }
    const float3 corner = vload3(0, light->corner), u = vload3(0, light->edge_u), v = vload3(0, light->edge_v);
    const Packet to = {corner.x + chance.point_x * u.x + chance.point_y * v.x - origin.x,
                       corner.y + chance.point_x * u.y + chance.point_y * v.y - origin.y,
                       corner.z + chance.point_x * u.z + chance.point_y * v.z - origin.z};
    const int16 is_lit = is_chosen & (dot_packet(vload3(0, light->normal), to) < 0.0f) &
                         (dot_packet(normal, to) > 0.0f) & (light->area > 0 ? -1 : 0);
    d.x = is_lit ? to.x : d.x;
    d.y = is_lit ? to.y : d.y;
    d.z = is_lit ? to.z : d.z;
  }
  return d;
}

// what the sixteen meet; false: not all the same triangle of a receiver, or one that takes more than this
static inline bool find_receiver(const Shading scene, const uint first, global const float4* hit,
                                 global const uint* hit_instance, global const float4* direction, Receiver* r) {
  const uint triangle = as_uint(hit[first].w), i = hit_instance[first];
  if (triangle == NO_TRIANGLE) return false;
  for (uint k = 1; k < PACKET; ++k)
    if (as_uint(hit[first + k].w) != triangle || hit_instance[first + k] != i) return false;
  global const Instance* instance = scene.instances + i;
  const uint more = INSTANCE_NORMALS | INSTANCE_COLORS | INSTANCE_SECOND_UVS | INSTANCE_CUTOUT;
  if (instance->visual == 0 || (instance->flags & more)) return false;
  r->material = scene.materials[instance->material];
  if (r->material.kind != MATERIAL_SHADOW_RECEIVER || (r->material.flags & MATERIAL_EMITS)) return false;
  r->surface = surface_at(instance, scene.triangles, scene.vertices, triangle, 0.0f, 0.0f);
  const uint3 corner = vload3(triangle, scene.triangles);
  const uint corners[3] = {corner.x, corner.y, corner.z};
  for (int c = 0; c < 3; ++c) {
    r->corner[c] = vload3(0, scene.vertices[corners[c]].point);
    r->uv[c] = vload2(0, scene.vertices[corners[c]].uv);
  }
  const bool is_front = dot(r->surface.face, direction[first].xyz) < 0;
  for (uint k = 1; k < PACKET; ++k)
    if ((dot(r->surface.face, direction[first + k].xyz) < 0) != is_front) return false;
  r->normal = is_front ? r->surface.face : -r->surface.face;
  return true;
}

// where shadow rays begin [m]
static inline Packet shadow_origins(const Receiver r, global const Instance* instance, const float16 u,
                                    const float16 v) {
  Packet p = {between(u, v, r.corner[0].x, r.corner[1].x, r.corner[2].x),
              between(u, v, r.corner[0].y, r.corner[1].y, r.corner[2].y),
              between(u, v, r.corner[0].z, r.corner[1].z, r.corner[2].z)};
  if (!(instance->flags & INSTANCE_UNMOVED)) p = affine_points(instance->to_world, p);
  const float16 offset = 4e-6f * max((float16)(1.0f), max(fabs(p.x), max(fabs(p.y), fabs(p.z))));  // leave_surface()
  p.x += r.normal.x * offset;
  p.y += r.normal.y * offset;
  p.z += r.normal.z * offset;
  return p;
}

// as in shade.cl, of the slots 0 .. n - 1, whose paths the launch has just started outside of glass;  a work-item takes
// PACKET of them;  hit: what is shaded has SHADED for its triangle
kernel __attribute__((reqd_work_group_size(4, 1, 1))) void shade_receivers(
    const uint n, const Launch launch, const uint notes_features, global const uint2* restrict stream,
    global const Instance* restrict instances, global const Material* restrict materials,
    global const TextureInfo* restrict textures, global const uchar4* restrict texels, constant float* restrict decode,
    global const uint* restrict triangles, global const Vertex* restrict vertices,
    global const float* restrict second_uvs, global const Light* restrict lights, global float4* restrict hit,
    global const uint* restrict hit_instance, global const float4* restrict direction,
    global const float4* restrict throughput, global float4* restrict radiance, global float4* restrict shadow_origin,
    global float4* restrict shadow_direction, global float4* restrict shadow_light, global uint* restrict alive,
    global float4* restrict feature_color, global float4* restrict feature_normal) {
  const uint first = get_global_id(0) * PACKET;
  if (first + PACKET > n) return;
  const Shading scene = {instances, materials,  textures, texels, decode, triangles, vertices,
                         0,         second_uvs, lights,   0,      0,      0};
  Receiver r;
  if (!find_receiver(scene, first, hit, hit_instance, direction, &r)) return;
  global const Instance* instance = instances + hit_instance[first];

  float us[PACKET], vs[PACKET];
  uint keys[PACKET], samples[PACKET];
  for (uint k = 0; k < PACKET; ++k) {
    us[k] = hit[first + k].y;
    vs[k] = hit[first + k].z;
    keys[k] = stream[first + k].x;
    samples[k] = stream[first + k].y;
  }
  const float16 u = vload16(0, us), v = vload16(0, vs);
  const PacketChance chance = draw_packet_chance(vload16(0, keys), vload16(0, samples));
  const Packet origin = shadow_origins(r, instance, u, v);
  const Packet even = even_directions(r.normal, chance.material_x, chance.material_y);
  uint others;
  const Packet lamp = lamp_directions(launch, scene, origin, r.normal, chance, &others);
  const int16 is_ambient = chance.roulette < r.material.own_number;
  const Packet to_light = {is_ambient ? even.x : lamp.x, is_ambient ? even.y : lamp.y, is_ambient ? even.z : lamp.z};
  Lanes lanes;
  store_packet(origin, lanes.origin);
  store_packet(to_light, lanes.direction);
  vstore16(between(u, v, r.uv[0].x, r.uv[1].x, r.uv[2].x), 0, us);
  vstore16(between(u, v, r.uv[0].y, r.uv[1].y, r.uv[2].y), 0, vs);

  for (uint k = 0; k < PACKET; ++k) {
    const uint slot = first + k;
    r.surface.uv = (float2)(us[k], vs[k]);
    const float3 carried = throughput[slot].xyz;
    const float3 color = vload3(0, r.material.color) * texture_at(scene, r.material.texture, r.surface.uv);
    const Notes notes = {notes_features, slot, 1.0f, feature_color, feature_normal};
    if (notes.is_wanted)
      write_note(notes, note_surface(scene, r.material, color, r.surface, direction[slot].xyz), carried);
    const float3 shown = carried * color * launch.receiver_scale, shaded = shown * r.material.shadow_strength;
    const float3 from = lane_origin(&lanes, k);
    const float3 to = others >> k & 1u ? light_of_receiver(launch, scene, r.material.own_number, from, r.normal,
                                                           draw_chance(stream[slot], 0))
                                       : lane_direction(&lanes, k);
    const bool has_shadow = r.material.shadow_strength != 0 && dot(to, to) != 0;
    const float3 lit = shown * (1.0f - r.material.shadow_strength);
    radiance[slot] = (float4)(has_shadow ? lit : lit + shaded, 0);
    hit[slot].w = as_float(SHADED);
    alive[slot] = 0;
    shadow_origin[slot] = (float4)(from, as_float(has_shadow ? SHADOW_RECEIVER : SHADOW_NONE));
    if (!has_shadow) continue;
    shadow_direction[slot] = (float4)(to, 0);
    shadow_light[slot] = (float4)(shaded, 1.0f);
  }
}
