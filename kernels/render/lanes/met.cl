// Sixteen paths where they hit: surfaces, textures, random numbers and light samples side by side. The formulas are those
// of surface.cl, texture.cl, diffuse.cl, frame.cl and lights.cl, which this equals up to rounding.
#ifndef PVG_RENDER_LANES_MET_CL
#define PVG_RENDER_LANES_MET_CL
#include "render/interact.cl"
#include "render/met_surface.cl"
#include "render/lanes/rows.cl"

#define ROWS_OF(T) (sizeof(T) / sizeof(float4))

typedef struct {
  uint lanes;          // bits of those that hold a path of their own
  uint place[PACKET];  // in the queue
  uint slot[PACKET];
  uint instance[PACKET], material[PACKET], triangle[PACKET];
  Packet direction, throughput;
  uint16 flags, media;
  float16 t, u, v;  // of the hit
} Paths;

typedef struct {
  Packet x, y, z;
} Frames;

typedef struct {
  Packet point, face, shading;  // world; the normals are unit, outward
  float16 texture_u, texture_v;
} Surfaces;

// the random numbers of a bounce, as in Chance
typedef struct {
  float16 point_x, point_y, choice_x, choice_y, material_x, material_y, material_choice, roulette;
} Chances;

typedef struct {
  Packet to_light, radiance;
  float16 pdf;
} LightSamples;

// the two choices that all surfaces need, by the numbers of draw_chance();  key, sample: of the others
static inline void draw_choices(global const uint2* stream, const Paths* p, const uint depth, uint16* key,
                                uint16* sample, Chances* c) {
  uint keys[PACKET], samples[PACKET];
  for (uint k = 0; k < PACKET; ++k) {
    const uint2 s = stream[p->slot[k]];
    keys[k] = s.x;
    samples[k] = s.y;
  }
  *key = vload16(0, keys);
  *sample = vload16(0, samples);
  sample_2d_16(*key, *sample, 5 + 4 * depth, &c->material_choice, &c->roulette);
}
// all, for surfaces that scatter
static inline Chances draw_chances(global const uint2* stream, const Paths* p, const uint depth) {
  Chances c;
  uint16 key, sample;
  draw_choices(stream, p, depth, &key, &sample, &c);
  sample_2d_16(key, sample, 2 + 4 * depth, &c.point_x, &c.point_y);
  sample_2d_16(key, sample, 3 + 4 * depth, &c.choice_x, &c.choice_y);
  sample_2d_16(key, sample, 4 + 4 * depth, &c.material_x, &c.material_y);
  return c;
}

static inline Frames make_frames(const Packet n) {
  const float16 sign = n.z >= 0.0f ? sixteen(1.0f) : sixteen(-1.0f);
  const float16 a = -1.0f / (sign + n.z), b = n.x * n.y * a;
  const Frames f = {{1.0f + sign * n.x * n.x * a, sign * b, -sign * n.x}, {b, sign + n.y * n.y * a, -n.y}, n};
  return f;
}
static inline Packet to_locals(const Frames f, const Packet w) {
  const Packet p = {dots(f.x, w), dots(f.y, w), dots(f.z, w)};
  return p;
}
static inline Packet to_worlds(const Frames f, const Packet w) {
  return plus(plus(times(f.x, w.x), times(f.y, w.y)), times(f.z, w.z));
}

// small_sin_cos()
static inline void small_sines(const float16 x, float16* sine, float16* cosine) {
  const float16 x2 = x * x;
  *sine = x * (1 - x2 * (1 / 6.0f - x2 * (1 / 120.0f - x2 * (1 / 5040.0f - x2 * (1 / 362880.0f)))));
  *cosine = 1 - x2 * (1 / 2.0f - x2 * (1 / 24.0f - x2 * (1 / 720.0f - x2 * (1 / 40320.0f))));
}

// local directions by the cosine, as diffuse_sample() draws them
static inline Packet cosine_directions(const float16 u, const float16 v) {
  const float16 a = 2 * u - 1, b = 2 * v - 1;
  const int16 is_wide = fabs(a) > fabs(b);
  const float16 r = is_wide ? a : b;
  float16 sine, cosine;
  small_sines(M_PI_4_F * ((is_wide ? b : a) / r), &sine, &cosine);
  const float16 disc_x = r == 0.0f ? sixteen(0.0f) : r * (is_wide ? cosine : sine);
  const float16 disc_y = r == 0.0f ? sixteen(0.0f) : r * (is_wide ? sine : cosine);
  const Packet d = {disc_x, disc_y, sqrt(largest(sixteen(1e-8f), 1.0f - (disc_x * disc_x + disc_y * disc_y)))};
  return d;
}

static inline float16 ray_offsets(const Packet point) {
  return 4e-6f * largest(largest(sixteen(1.0f), fabs(point.x)), largest(fabs(point.y), fabs(point.z)));
}
static inline Packet leave_surfaces(const Packet point, const Packet normal) {
  return plus(point, times(normal, ray_offsets(point)));
}

static inline Packet between_corners(const float16 wa, const float16 wb, const float16 wc, const Packet a,
                                     const Packet b, const Packet c) {
  return plus(plus(times(a, wa), times(b, wb)), times(c, wc));
}

static inline Surfaces surfaces_at(const Shading scene, const Paths* p) {
  uint a_at[PACKET], b_at[PACKET], c_at[PACKET], flags[PACKET], is_any_moved = 0, is_any_detailed = 0;
  for (uint k = 0; k < PACKET; ++k) {
    const uint3 corner = vload3(p->triangle[k], scene.triangles);
    a_at[k] = corner.x;
    b_at[k] = corner.y;
    c_at[k] = corner.z;
    flags[k] = scene.instances[p->instance[k]].flags;
    is_any_moved |= ~flags[k] & INSTANCE_UNMOVED;
    is_any_detailed |= (flags[k] & INSTANCE_NORMALS) | (scene.materials[p->material[k]].texture >= 0 ? 1u : 0u);
  }
  global const float4* vertices = (global const float4*)scene.vertices;
  // a vertex: point and normal.x, then the rest of the normal and the texture coordinates
  const uint stride = ROWS_OF(Vertex);
  const Rows a0 = load_rows(vertices, a_at, stride, 0), b0 = load_rows(vertices, b_at, stride, 0),
             c0 = load_rows(vertices, c_at, stride, 0);
  const float16 wb = p->u, wc = p->v, wa = 1.0f - wb - wc;
  Surfaces s;
  s.point = between_corners(wa, wb, wc, vectors_of(a0), vectors_of(b0), vectors_of(c0));
  Packet face = crosses(minus(vectors_of(b0), vectors_of(a0)), minus(vectors_of(c0), vectors_of(a0)));
  Packet n = {0.0f, 0.0f, 0.0f};
  s.texture_u = s.texture_v = 0.0f;
  if (is_any_detailed) {
    const Rows a1 = load_rows(vertices, a_at, stride, 1), b1 = load_rows(vertices, b_at, stride, 1),
               c1 = load_rows(vertices, c_at, stride, 1);
    n.x = wa * a0.w + wb * b0.w + wc * c0.w;
    n.y = wa * a1.x + wb * b1.x + wc * c1.x;
    n.z = wa * a1.y + wb * b1.y + wc * c1.y;
    s.texture_u = wa * a1.z + wb * b1.z + wc * c1.z;
    s.texture_v = wa * a1.w + wb * b1.w + wc * c1.w;
  }
  if (is_any_moved) {
    global const float4* instances = (global const float4*)scene.instances;
    const uint step = ROWS_OF(Instance);
    const Rows x = load_rows(instances, p->instance, step, 3), y = load_rows(instances, p->instance, step, 4),
               z = load_rows(instances, p->instance, step, 5);
    const Packet moved = {dots(vectors_of(x), s.point) + x.w, dots(vectors_of(y), s.point) + y.w,
                          dots(vectors_of(z), s.point) + z.w};
    s.point = moved;
    // normals go with the transposed inverse
    const Packet ix = vectors_of(load_rows(instances, p->instance, step, 0)),
                 iy = vectors_of(load_rows(instances, p->instance, step, 1)),
                 iz = vectors_of(load_rows(instances, p->instance, step, 2));
    face = between_corners(face.x, face.y, face.z, ix, iy, iz);
    n = between_corners(n.x, n.y, n.z, ix, iy, iz);
  }
  s.face = units(face);
  const float16 length2 = dots(n, n);
  const int16 is_smooth = ((as_int16(vload16(0, flags)) & (int)INSTANCE_NORMALS) != 0) & (length2 > 1e-12f);
  s.shading = chosen(is_smooth, times(n, rsqrt(length2)), s.face);
  return s;
}

// sample_light() of these lights, as if all were rectangles;  is_one: they are all the same
static inline LightSamples sample_rectangles(const Shading scene, const uint* light, const bool is_one,
                                             const Packet origin, const Chances* c) {
  global const float4* lights = (global const float4*)scene.lights;
#define LIGHT_ROWS(offset) load_rows_or_one(lights, light, is_one, ROWS_OF(Light), offset)
  const Rows chance = LIGHT_ROWS(0), corner = LIGHT_ROWS(1);
  const Packet edge_u = vectors_of(LIGHT_ROWS(2)), edge_v = vectors_of(LIGHT_ROWS(3)), normal = vectors_of(LIGHT_ROWS(4));
  LightSamples s;
  s.radiance = vectors_of(LIGHT_ROWS(5));
#undef LIGHT_ROWS
  s.to_light = minus(plus(vectors_of(corner), plus(times(edge_u, c->point_x), times(edge_v, c->point_y))), origin);
  const float16 d2 = dots(s.to_light, s.to_light), cosine = -dots(normal, s.to_light) * rsqrt(d2);
  const int16 shines = (cosine > 0.0f) & (corner.w > 0.0f);
  s.pdf = shines ? chance.y * d2 / (corner.w * cosine) : sixteen(0.0f);
  return s;
}

// once more one by one, of any kind, those of the lanes in `which` (bits)
static inline void sample_alone(const Launch launch, const Shading scene, const uint which, const Packet origin,
                                const Chances* c, LightSamples* s) {
  float from[3][PACKET], to[3][PACKET], radiance[3][PACKET], pdf[PACKET], chances[4][PACKET];
  store_packet(origin, from);
  store_packet(s->to_light, to);
  store_packet(s->radiance, radiance);
  vstore16(s->pdf, 0, pdf);
  vstore16(c->choice_x, 0, chances[0]);
  vstore16(c->choice_y, 0, chances[1]);
  vstore16(c->point_x, 0, chances[2]);
  vstore16(c->point_y, 0, chances[3]);
  for (uint rest = which; rest; rest &= rest - 1) {
    const uint k = lowest_bit(rest);
    const LightSample one =
        sample_light(launch, scene, (float3)(from[0][k], from[1][k], from[2][k]),
                     (float2)(chances[0][k], chances[1][k]), (float2)(chances[2][k], chances[3][k]));
    to[0][k] = one.to_light.x;
    to[1][k] = one.to_light.y;
    to[2][k] = one.to_light.z;
    radiance[0][k] = one.radiance.x;
    radiance[1][k] = one.radiance.y;
    radiance[2][k] = one.radiance.z;
    pdf[k] = one.pdf;
  }
  s->to_light = load_packet(to);
  s->radiance = load_packet(radiance);
  s->pdf = vload16(0, pdf);
}

// sample_light(), n_lights > 0
static inline LightSamples sample_lights(const Launch launch, const Shading scene, const Packet origin,
                                         const Chances* c) {
  float choice_y[PACKET];
  uint light[PACKET], others = 0;
  if (launch.n_lights == 1) {
    for (uint k = 0; k < PACKET; ++k) light[k] = 0;
    LightSamples s = sample_rectangles(scene, light, true, origin, c);
    if (scene.lights->kind != LIGHT_RECTANGLE) sample_alone(launch, scene, 0xffffu, origin, c, &s);
    return s;
  }
  vstore16(c->choice_y, 0, choice_y);
  vstore16(min(convert_uint16(c->choice_x * (float)launch.n_lights), (uint16)(launch.n_lights - 1)), 0, light);
  for (uint k = 0; k < PACKET; ++k) {  // choose_light()
    global const Light* place = scene.lights + light[k];
    light[k] = choice_y[k] < place->keep ? light[k] : place->other;
    others |= scene.lights[light[k]].kind != LIGHT_RECTANGLE ? 1u << k : 0u;
  }
  LightSamples s = sample_rectangles(scene, light, false, origin, c);
  if (others) sample_alone(launch, scene, others, origin, c, &s);
  return s;
}

// values of the texels at[k];  decode_from: where their table begins
static inline Packet decoded_texels(const Shading scene, const uint* at, const uint* decode_from) {
  float r[PACKET], g[PACKET], b[PACKET];
  uchar4 c[PACKET];
  for (uint k = 0; k < PACKET; ++k) c[k] = scene.texels[at[k]];
  for (uint k = 0; k < PACKET; ++k) {
    constant float* decode = scene.decode + decode_from[k];
    r[k] = decode[c[k].x];
    g[k] = decode[c[k].y];
    b[k] = decode[c[k].z];
  }
  const Packet p = {vload16(0, r), vload16(0, g), vload16(0, b)};
  return p;
}

static inline Packet mixed(const Packet a, const Packet b, const float16 share) {
  const Packet p = {a.x + (b.x - a.x) * share, a.y + (b.y - a.y) * share, a.z + (b.z - a.z) * share};
  return p;
}

// texture_color()
static inline Packet texture_colors(const Shading scene, const uint* texture, const float16 u, const float16 v) {
  uint decode_from[PACKET], first[PACKET], width[PACKET], height[PACKET];
  for (uint k = 0; k < PACKET; ++k) {
    const TextureInfo info = scene.textures[texture[k]];
    first[k] = info.first;
    width[k] = info.width;
    height[k] = info.height;
    decode_from[k] = info.is_linear ? 256u : 0u;
  }
  const int16 w = as_int16(vload16(0, width)), h = as_int16(vload16(0, height));
  const float16 x = (u - floor(u)) * convert_float16(w) - 0.5f, y = (v - floor(v)) * convert_float16(h) - 0.5f;
  const float16 x_floor = floor(x), y_floor = floor(y);
  const int16 x_int = convert_int16(x_floor), y_int = convert_int16(y_floor);
  const int16 x_last = w - 1, y_last = h - 1;
  const int16 x0 = x_int < 0 ? x_last : (x_int < x_last ? x_int : x_last);
  const int16 y0 = y_int < 0 ? y_last : (y_int < y_last ? y_int : y_last);
  const int16 x1 = x0 == x_last ? (int16)(0) : x0 + 1, y1 = y0 == y_last ? (int16)(0) : y0 + 1;
  const int16 row0 = as_int16(vload16(0, first)) + y0 * w, row1 = as_int16(vload16(0, first)) + y1 * w;
  uint at[4][PACKET];
  vstore16(as_uint16(row0 + x0), 0, at[0]);
  vstore16(as_uint16(row0 + x1), 0, at[1]);
  vstore16(as_uint16(row1 + x0), 0, at[2]);
  vstore16(as_uint16(row1 + x1), 0, at[3]);
  const float16 right = x - x_floor;
  const Packet top = mixed(decoded_texels(scene, at[0], decode_from), decoded_texels(scene, at[1], decode_from), right);
  const Packet bottom =
      mixed(decoded_texels(scene, at[2], decode_from), decoded_texels(scene, at[3], decode_from), right);
  return mixed(top, bottom, y - y_floor);
}

// surface_color() without vertex colours;  texture, color: of the materials
static inline Packet surface_colors(const Shading scene, const Surfaces* s, const int16 texture, const Packet color) {
  const int16 has_texture = texture >= 0;
  if (!mask16(has_texture)) return color;
  uint number[PACKET];
  vstore16(as_uint16(has_texture ? texture : (int16)(0)), 0, number);  // any will do for the lanes without one
  const Packet texels = texture_colors(scene, number, s->texture_u, s->texture_v);
  return chosen(has_texture, products(color, texels), color);
}
#endif
