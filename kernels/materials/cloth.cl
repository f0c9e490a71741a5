// Cloth: a diffuse ground under fibres that stand up and shine at grazing angles. Sheen of Estevez and Kulla 2017,
//   D(m) = (2 + 1/alpha) sin(m)^(1/alpha) / (2 pi) [1/sr],  V = 1 / (4 (cos_i + cos_o - cos_i cos_o)) (Neubelt),
//   f cos = color / pi (1 - s E(o)) (1 - s E(i)) cos_i + sheen D V cos_i,
// with E the directional albedo of the sheen (as in KHR_materials_sheen), s its largest channel, alpha = roughness^2; own_color: sheen, own_number: roughness.
// Roughness 0.5 to 1: below it D V would reflect more light than there is.
#ifndef PVG_MATERIALS_CLOTH_CL
#define PVG_MATERIALS_CLOTH_CL
#include "materials/diffuse.cl"
#include "materials/microfacet.cl"

#define SHEEN_ROUGHNESS_ROWS 6
#define SHEEN_COSINE_COLUMNS 8
// E of D V by the midpoint rule; rows: roughness 0.5 to 1, columns: the root of the cosine, 0 to 1
constant float sheen_albedo_table[SHEEN_ROUGHNESS_ROWS][SHEEN_COSINE_COLUMNS] = {
    {0.9282f, 0.8359f, 0.6750f, 0.5099f, 0.3569f, 0.2234f, 0.1137f, 0.0313f},
    {0.8205f, 0.7473f, 0.6195f, 0.4872f, 0.3614f, 0.2464f, 0.1442f, 0.0563f},
    {0.7481f, 0.6866f, 0.5796f, 0.4685f, 0.3617f, 0.2615f, 0.1682f, 0.0816f},
    {0.6971f, 0.6434f, 0.5502f, 0.4536f, 0.3603f, 0.2716f, 0.1868f, 0.1046f},
    {0.6600f, 0.6115f, 0.5280f, 0.4417f, 0.3584f, 0.2786f, 0.2014f, 0.1246f},
    {0.6321f, 0.5875f, 0.5109f, 0.4322f, 0.3564f, 0.2837f, 0.2129f, 0.1415f}};

static inline float sheen_albedo(const float cosine, const float roughness) {
  const float row = clamp((roughness - 0.5f) / 0.5f, 0.0f, 1.0f) * (SHEEN_ROUGHNESS_ROWS - 1);
  const float column = sqrt(clamp(cosine, 0.0f, 1.0f)) * (SHEEN_COSINE_COLUMNS - 1);
  const int i = min((int)row, SHEEN_ROUGHNESS_ROWS - 2), k = min((int)column, SHEEN_COSINE_COLUMNS - 2);
  const float a = row - (float)i, b = column - (float)k;
  return mix(mix(sheen_albedo_table[i][k], sheen_albedo_table[i][k + 1], b),
             mix(sheen_albedo_table[i + 1][k], sheen_albedo_table[i + 1][k + 1], b), a);
}

// f cos [1/sr]
static inline float3 cloth_eval(const PointMaterial p, const float3 wo, const float3 wi) {
  if (wo.z <= 0 || wi.z <= 0) return (float3)(0.0f);
  const float3 sheen = p.own_color;
  const float roughness = p.own_number;
  const float3 m = reflecting_normal(wo, wi);
  const float power = 1.0f / (roughness * roughness);
  // the power by exp and log: pow() takes care of what does not come here and twice the time
  const float sines = exp(0.5f * power * log(max(1e-30f, 1.0f - m.z * m.z)));
  const float D = (2.0f + power) * sines * (0.5f * M_1_PI_F);
  const float V = 1.0f / (4.0f * (wi.z + wo.z - wi.z * wo.z));
  const float s = max(sheen.x, max(sheen.y, sheen.z));
  const float ground = (1.0f - s * sheen_albedo(wo.z, roughness)) * (1.0f - s * sheen_albedo(wi.z, roughness));
  return p.color * (ground * wi.z * M_1_PI_F) + sheen * (D * V * wi.z);
}

// half of the samples by the cosine, half evenly: the sheen has no peak
static inline float cloth_pdf(const PointMaterial p, const float3 wo, const float3 wi) {
  return wo.z > 0 && wi.z > 0 ? 0.5f * wi.z * M_1_PI_F + 0.25f * M_1_PI_F : 0.0f;
}

static inline MaterialSample cloth_sample(const PointMaterial p, const float3 wo, const float2 u, const float choice) {
  MaterialSample s = diffuse_sample(p, wo, u, choice);
  if (choice < 0.5f) {
    const float z = max(1e-4f, u.x), r = sqrt(1.0f - z * z), phi = 2.0f * M_PI_F * u.y;
    s.direction = (float3)(r * cos(phi), r * sin(phi), z);
  }
  s.pdf = cloth_pdf(p, wo, s.direction);
  s.weight = s.pdf > 0 ? cloth_eval(p, wo, s.direction) / s.pdf : (float3)(0.0f);
  return s;
}
#endif
