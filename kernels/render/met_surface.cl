// The surface where a path meets it: side, normal bent by its map, material with its textures looked up.
#ifndef PVG_RENDER_MET_SURFACE_CL
#define PVG_RENDER_MET_SURFACE_CL
#include "render/lights.cl"
#include "render/media.cl"

static inline float3 texture_at(const Shading scene, const int texture, const float2 uv) {
  return texture < 0 ? (float3)(1.0f)
                     : texture_color(scene.textures[texture], scene.texels, scene.decode, uv);
}

// the texture coordinates of a triangle's corners that lay out the normal map
static inline void normal_map_corners(const Shading scene, global const Instance* instance, const uint flags,
                                      const uint triangle, float2 uv[3]) {
  const uint3 corner = vload3(triangle, scene.triangles);
  const uint corners[3] = {corner.x, corner.y, corner.z};
  const bool is_second = (flags & SECOND_UVS_NORMAL) && (instance->flags & INSTANCE_SECOND_UVS);
  for (int k = 0; k < 3; ++k)
    uv[k] = is_second ? second_uv_of_corner(instance, scene.second_uvs, corners[k])
                      : vload2(0, scene.vertices[corners[k]].uv);
}

static inline PointMaterial material_at(const Shading scene, const Material m, const float3 color, const Surface s,
                                        const float eta) {
  PointMaterial p = point_material(m, eta);
  p.color = color;
  if (m.metallic_roughness_texture >= 0) {
    const float3 t = texture_at(scene, m.metallic_roughness_texture, uv_for(s, m.flags, SECOND_UVS_METALLIC_ROUGHNESS));
    p.alpha = max(MIRROR_ALPHA, p.alpha * t.y * t.y);
    p.metallic *= t.z;
  }
  return p;
}

typedef struct {
  Boundary boundary;
  PointMaterial material;  // unless the boundary is hidden, as the normal
  float3 face, normal;     // unit, toward the path
} MetSurface;

static inline float3 surface_color(const Shading scene, global const Instance* instance, const Material m,
                                   const Surface s, const uint triangle, const float u, const float v) {
  float3 color = vload3(0, m.color);
  if (m.kind != MATERIAL_EMISSIVE) color *= texture_at(scene, m.texture, uv_for(s, m.flags, SECOND_UVS_COLOR));
  if (instance->flags & INSTANCE_COLORS) color *= vertex_color(instance, scene.triangles, scene.colors, triangle, u, v);
  return color;
}

// direction: of the path, toward the surface;  media: what it is inside of;  triangle: index into those of all meshes
static inline MetSurface met_surface(const Shading scene, global const Instance* instance, const uint triangle,
                                     const Material m, const float3 color, const Surface s, const float3 direction,
                                     const uint media) {
  MetSurface met;
  const bool enters = dot(s.face, direction) < 0;
  met.face = enters ? s.face : -s.face;
  const Boundary plain = {m.ior, media, false};
  met.boundary = plain;
  if (m.flags & MATERIAL_HAS_INSIDE)
    met.boundary = boundary_of(media, instance->material, scene.materials, enters);
  if (met.boundary.is_hidden) return met;
  met.normal = dot(s.shading, met.face) > 0 ? s.shading : -s.shading;
  if (m.normal_texture >= 0) {
    const float3 bend = 2.0f * texture_at(scene, m.normal_texture, uv_for(s, m.flags, SECOND_UVS_NORMAL)) - 1.0f;
    float2 corner_uvs[3];
    normal_map_corners(scene, instance, m.flags, triangle, corner_uvs);
    // on the back of a surface the map's directions along it stay
    met.normal = bent_normal(instance, scene.triangles, scene.vertices, triangle, corner_uvs, met.normal,
                             (float3)(bend.xy * m.normal_scale, bend.z));
  }
  if (dot(met.normal, direction) >= 0) met.normal = met.face;  // a shading normal that looks away cannot be used
  met.material = material_at(scene, m, color, s, met.boundary.eta);
  return met;
}
#endif
