// Materials at sixteen points of surfaces side by side: diffuse, rough conductors, and glTF's metallic-roughness model
// without transmission. The formulas are those of kernels/materials (diffuse, conductor, metallic_roughness, dielectric,
// microfacet), which this equals up to rounding.
#ifndef PVG_RENDER_LANES_SCATTER_CL
#define PVG_RENDER_LANES_SCATTER_CL
#include "render/lanes/met.cl"

// as PointMaterial; kind: the same for all
typedef struct {
  uint kind;
  Packet color, own_color;
  float16 alpha, metallic, eta;
} PointMaterials;

// as MaterialSample
typedef struct {
  Packet direction, weight;
  float16 pdf;
} MaterialSamples;

// of an angle in whole turns, 0 to 1: what it is off the nearest quarter turn is within pi/4
static inline void sines_of_turn(const float16 turn, float16* sine, float16* cosine) {
  const float16 quarter = floor(4.0f * turn + 0.5f);
  float16 s, c;
  small_sines((4.0f * turn - quarter) * (0.5f * M_PI_F), &s, &c);
  const int16 number = convert_int16(quarter), is_odd = (number & 1) != 0;
  const float16 sine_size = is_odd ? c : s, cosine_size = is_odd ? s : c;
  *sine = (number & 2) != 0 ? -sine_size : sine_size;
  *cosine = ((number + 1) & 2) != 0 ? -cosine_size : cosine_size;
}

static inline float16 luminances(const Packet c) { return 0.2126f * c.x + 0.7152f * c.y + 0.0722f * c.z; }

static inline float16 fresnel_dielectrics(const float16 cosine, const float16 eta) {
  const float16 sin2 = (1.0f - cosine * cosine) / (eta * eta);
  const float16 cos_t = sqrt(largest(sixteen(0.0f), 1.0f - sin2));
  const float16 s = (cosine - eta * cos_t) / (cosine + eta * cos_t);
  const float16 p = (eta * cosine - cos_t) / (eta * cosine + cos_t);
  return sin2 >= 1.0f ? sixteen(1.0f) : 0.5f * (s * s + p * p);
}

static inline Packet fresnel_schlicks(const Packet reflectance, const float16 cosine) {
  const float16 x = clamped(1.0f - cosine), x5 = x * x * x * x * x;
  const Packet F = {reflectance.x + (1.0f - reflectance.x) * x5, reflectance.y + (1.0f - reflectance.y) * x5,
                    reflectance.z + (1.0f - reflectance.z) * x5};
  return F;
}

static inline Packet fresnel_conductors(const PointMaterials p, const float16 cosine) {
  const float16 x = clamped(1.0f - cosine), x3 = x * x * x;
  return minus(fresnel_schlicks(p.color, cosine), times(p.own_color, (1.0f - x) * x3 * x3));
}

static inline float16 ggx_densities(const Packet m, const float16 alpha) {
  const float16 a2 = alpha * alpha, k = (a2 - 1.0f) * m.z * m.z + 1.0f;
  return a2 / (M_PI_F * k * k);
}
static inline float16 ggx_lambdas(const Packet w, const float16 alpha) {
  const float16 tan2 = (w.x * w.x + w.y * w.y) / (w.z * w.z);
  return 0.5f * (sqrt(1.0f + alpha * alpha * tan2) - 1.0f);
}
static inline float16 ggx_visible_densities(const Packet wo, const Packet m, const float16 alpha) {
  return ggx_densities(m, alpha) * largest(sixteen(0.0f), dots(wo, m)) / (wo.z * (1.0f + ggx_lambdas(wo, alpha)));
}
static inline float16 ggx_reflections(const float16 alpha, const Packet wo, const Packet wi, const Packet m) {
  return ggx_densities(m, alpha) / (4.0f * wo.z * (1.0f + ggx_lambdas(wo, alpha) + ggx_lambdas(wi, alpha)));
}

static inline Packet ggx_visible_normals(const Packet wo, const float16 alpha, const float16 u, const float16 turn) {
  const Packet stretched = {alpha * wo.x, alpha * wo.y, wo.z}, v = units(stretched);
  const float16 length2 = v.x * v.x + v.y * v.y, inverse = rsqrt(length2);
  const int16 is_aside = length2 > 1e-14f;  // seen from above every tangent will do
  const Packet t1 = {is_aside ? -v.y * inverse : sixteen(1.0f), is_aside ? v.x * inverse : sixteen(0.0f), sixteen(0.0f)};
  const Packet t2 = crosses(v, t1);
  float16 sine, cosine;
  sines_of_turn(turn, &sine, &cosine);
  const float16 r = sqrt(u), a = r * cosine, s = 0.5f * (1.0f + v.z), a2 = 1.0f - a * a;
  const float16 b = (1.0f - s) * sqrt(largest(sixteen(0.0f), a2)) + s * r * sine;
  const Packet n = plus(plus(times(t1, a), times(t2, b)), times(v, sqrt(largest(sixteen(0.0f), a2 - b * b))));
  const Packet shrunk = {alpha * n.x, alpha * n.y, largest(sixteen(1e-6f), n.z)};
  return units(shrunk);
}

static inline float16 coat_fresnels(const PointMaterials p, const float16 cosine) {
  return fresnel_dielectrics(clamped(cosine), p.eta);
}
static inline Packet coat_reflectances(const PointMaterials p, const float16 cosine, const float16 F) {
  const Packet coat = {F, F, F};
  return mixed(coat, fresnel_schlicks(p.color, cosine), p.metallic);
}
static inline float16 diffuse_shares(const PointMaterials p, const Packet wo) {
  const float16 F = coat_fresnels(p, wo.z);
  const float16 diffuse = (1.0f - p.metallic) * (1.0f - F) * luminances(p.color);
  const float16 facets = luminances(coat_reflectances(p, wo.z, F));
  return diffuse > 0.0f ? diffuse / (diffuse + facets) : sixteen(0.0f);
}

static inline Packet materials_eval(const PointMaterials p, const Packet wo, const Packet wi) {
  const Packet zero = {0.0f, 0.0f, 0.0f};
  const int16 is_above = (wo.z > 0.0f) & (wi.z > 0.0f);
  if (p.kind == MATERIAL_DIFFUSE) return chosen(is_above, times(p.color, wi.z * M_1_PI_F), zero);
  const Packet m = units(plus(wo, wi));
  if (p.kind == MATERIAL_CONDUCTOR)
    return chosen(is_above, times(fresnel_conductors(p, dots(wi, m)), ggx_reflections(p.alpha, wo, wi, m)), zero);
  const float16 cosine = dots(wo, m), F = coat_fresnels(p, cosine);
  const Packet coat = times(coat_reflectances(p, cosine, F), ggx_reflections(p.alpha, wo, wi, m));
  const float16 mean = p.eta > 1.0f ? (p.eta - 1.0f) / (4.08567f + 1.00071f * p.eta) : sixteen(0.0f);
  const float16 below =
      (1.0f - p.metallic) * (1.0f - coat_fresnels(p, wo.z)) * (1.0f - coat_fresnels(p, wi.z)) / (1.0f - mean);
  return chosen(is_above, plus(coat, times(p.color, below * wi.z * M_1_PI_F)), zero);
}

static inline float16 materials_pdf(const PointMaterials p, const Packet wo, const Packet wi) {
  const int16 is_above = (wo.z > 0.0f) & (wi.z > 0.0f);
  if (p.kind == MATERIAL_DIFFUSE) return is_above ? wi.z * M_1_PI_F : sixteen(0.0f);
  const Packet m = units(plus(wo, wi));
  if (p.kind == MATERIAL_CONDUCTOR)
    return is_above ? ggx_densities(m, p.alpha) / (4.0f * wo.z * (1.0f + ggx_lambdas(wo, p.alpha))) : sixteen(0.0f);
  const float16 diffuse = diffuse_shares(p, wo), cosine = dots(wo, m);
  const float16 facets = ggx_visible_densities(wo, m, p.alpha);
  const float16 pdf = diffuse * wi.z * M_1_PI_F + (1.0f - diffuse) * facets / (4.0f * cosine);
  return (is_above & (cosine > 0.0f)) ? pdf : sixteen(0.0f);
}

static inline MaterialSamples materials_sample(const PointMaterials p, const Packet wo, const Chances* chance) {
  const Packet zero = {0.0f, 0.0f, 0.0f};
  const int16 is_above = wo.z > 0.0f;
  MaterialSamples s;
  if (p.kind == MATERIAL_DIFFUSE) {
    s.direction = cosine_directions(chance->material_x, chance->material_y);
    s.pdf = is_above ? s.direction.z * M_1_PI_F : sixteen(0.0f);
    s.weight = chosen(is_above, p.color, zero);
    return s;
  }
  const Packet m = ggx_visible_normals(wo, p.alpha, chance->material_x, chance->material_y);
  Packet wi = minus(times(m, 2.0f * dots(wo, m)), wo);
  if (p.kind == MATERIAL_METALLIC_ROUGHNESS) {
    const int16 is_diffuse = chance->material_choice < diffuse_shares(p, wo);
    wi = chosen(is_diffuse, cosine_directions(chance->material_x, chance->material_y), wi);
  }
  const float16 pdf = materials_pdf(p, wo, wi);
  const int16 is_found = is_above & (wi.z > 0.0f) & (pdf > 0.0f);  // one that would meet a second facet is lost
  s.pdf = is_found ? pdf : sixteen(0.0f);
  s.direction = chosen(is_found, wi, wo);
  s.weight = chosen(is_found, times(materials_eval(p, wo, wi), 1.0f / pdf), zero);
  return s;
}
#endif
