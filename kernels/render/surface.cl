// The surface at a hit: point, normals and texture coordinates in the world.
#ifndef PVG_RENDER_SURFACE_CL
#define PVG_RENDER_SURFACE_CL
#include "render/traverse.cl"

typedef struct {
  float3 point;    // [m]
  float3 face;     // geometric normal, unit, outward
  float3 shading;  // interpolated normal, unit, outward, or the geometric one
  float2 uv;
} Surface;

// normals go with the transposed inverse
inline float3 affine_normal(global const float* to_object, const float3 n) {
  return (float3)(to_object[0] * n.x + to_object[4] * n.y + to_object[8] * n.z,
                  to_object[1] * n.x + to_object[5] * n.y + to_object[9] * n.z,
                  to_object[2] * n.x + to_object[6] * n.y + to_object[10] * n.z);
}

inline Surface surface_at(global const Instance* instance, global const uint* triangles, global const Vertex* vertices,
                          const uint triangle, const float u, const float v) {
  const uint3 corner = vload3(triangle, triangles);
  global const Vertex* a = vertices + corner.x;
  global const Vertex* b = vertices + corner.y;
  global const Vertex* c = vertices + corner.z;
  const float w = 1.0f - u - v;
  const float3 p = vload3(0, a->point), q = vload3(0, b->point), r = vload3(0, c->point);
  Surface s;
  s.point = affine_point(instance->to_world, w * p + u * q + v * r);
  s.face = normalize(affine_normal(instance->to_object, cross(q - p, r - p)));
  s.shading = s.face;
  if (instance->flags & INSTANCE_NORMALS) {
    const float3 n = affine_normal(instance->to_object,
                                   w * vload3(0, a->normal) + u * vload3(0, b->normal) + v * vload3(0, c->normal));
    const float length2 = dot(n, n);
    // normals that cancel say nothing
    if (length2 > 1e-12f) s.shading = n * rsqrt(length2);
  }
  s.uv = w * vload2(0, a->uv) + u * vload2(0, b->uv) + v * vload2(0, c->uv);
  return s;
}

// how far a new ray starts off its surface: more than the rounding of the point and of the change of frames (half a
// micrometre at 1 m), much less than a wall of glass or a contact gap
inline float ray_offset(const float3 point) {
  return 4e-6f * max(1.0f, max(fabs(point.x), max(fabs(point.y), fabs(point.z))));
}
inline float3 leave_surface(const float3 point, const float3 normal) { return point + normal * ray_offset(point); }
#endif
