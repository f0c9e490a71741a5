// Surfaces of tiny mirrors: the GGX distribution of their normals
//   D(m) = alpha^2 / (pi ((alpha^2 - 1) m_z^2 + 1)^2)  [1/sr]
// (Walter et al. 2007), Smith's masking, and samples of the normals that a direction sees (Heitz 2018).
#ifndef PVG_MATERIALS_MICROFACET_CL
#define PVG_MATERIALS_MICROFACET_CL
#include "materials/frame.cl"

static inline float ggx_density(const float3 m, const float alpha) {
  const float a2 = alpha * alpha, k = (a2 - 1.0f) * m.z * m.z + 1.0f;
  return a2 / (M_PI_F * k * k);
}

// Smith's Lambda(w)
static inline float ggx_lambda(const float3 w, const float alpha) {
  const float tan2 = (w.x * w.x + w.y * w.y) / (w.z * w.z);
  return 0.5f * (sqrt(1.0f + alpha * alpha * tan2) - 1.0f);
}

// density of the normals that wo sees, times wo . m:  D G1 (wo . m) / wo_z  [1/sr]
static inline float ggx_visible_density(const float3 wo, const float3 m, const float alpha) {
  return ggx_density(m, alpha) * max(0.0f, dot(wo, m)) / (wo.z * (1.0f + ggx_lambda(wo, alpha)));
}

// a normal of the facets that wo sees
static inline float3 ggx_visible_normal(const float3 wo, const float alpha, const float2 u) {
  const float3 v = normalize((float3)(alpha * wo.x, alpha * wo.y, wo.z));
  const float length2 = v.x * v.x + v.y * v.y;
  // seen from above every tangent will do
  const float3 t1 = length2 > 1e-14f ? (float3)(-v.y, v.x, 0) * rsqrt(length2) : (float3)(1, 0, 0);
  const float3 t2 = cross(v, t1);
  const float r = sqrt(u.x), phi = 2.0f * M_PI_F * u.y;
  const float a = r * cos(phi), s = 0.5f * (1.0f + v.z);
  const float b = (1.0f - s) * sqrt(max(0.0f, 1.0f - a * a)) + s * r * sin(phi);
  const float3 n = a * t1 + b * t2 + sqrt(max(0.0f, 1.0f - a * a - b * b)) * v;
  return normalize((float3)(alpha * n.x, alpha * n.y, max(1e-6f, n.z)));
}

// the facet normal that reflects wo to wi, or refracts it there, eta: index on wi's side / on wo's side
static inline float3 reflecting_normal(const float3 wo, const float3 wi) { return normalize(wo + wi); }
static inline float3 refracting_normal(const float3 wo, const float3 wi, const float eta) {
  const float3 m = normalize(wo + eta * wi);
  return m.z < 0 ? -m : m;
}

// solid angle of facet normals per solid angle of refracted directions: eta^2 |wi . m| / (wo . m + eta wi . m)^2
static inline float refraction_jacobian(const float3 wo, const float3 wi, const float3 m, const float eta) {
  const float d = dot(wo, m) + eta * dot(wi, m);
  return eta * eta * fabs(dot(wi, m)) / max(d * d, 1e-12f);
}

// false: total reflection
static inline bool refract_about(const float3 wo, const float3 m, const float eta, float3* wi) {
  const float cosine = dot(wo, m), sin2 = (1.0f - cosine * cosine) / (eta * eta);
  if (sin2 >= 1.0f) return false;
  *wi = (cosine / eta - sqrt(1.0f - sin2)) * m - wo / eta;
  return true;
}
#endif
