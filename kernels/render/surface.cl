// The surface at a hit: point, normals and texture coordinates in the world.
#ifndef PVG_RENDER_SURFACE_CL
#define PVG_RENDER_SURFACE_CL
#include "render/traverse.cl"

typedef struct {
  float3 point;    // [m]
  float3 face;     // geometric normal, unit, outward
  float3 shading;  // interpolated normal, unit, outward, or the geometric one
  float2 uv, second_uv;  // texture coordinates; the second are the first where the mesh has no second
} Surface;

// without the care that the language takes of lengths near the ends of the range
static inline float3 unit(const float3 v) { return v * rsqrt(max(dot(v, v), 1e-37f)); }

// normals go with the transposed inverse
static inline float3 affine_normal(global const float* to_object, const float3 n) {
  return (float3)(to_object[0] * n.x + to_object[4] * n.y + to_object[8] * n.z,
                  to_object[1] * n.x + to_object[5] * n.y + to_object[9] * n.z,
                  to_object[2] * n.x + to_object[6] * n.y + to_object[10] * n.z);
}

static inline Surface surface_at(global const Instance* instance, global const uint* triangles,
                                 global const Vertex* vertices, const uint triangle, const float u, const float v) {
  const uint3 corner = vload3(triangle, triangles);
  // a vertex is eight floats: point, normal, uv
  const float8 a = vload8(corner.x, (global const float*)vertices), b = vload8(corner.y, (global const float*)vertices),
               c = vload8(corner.z, (global const float*)vertices);
  const float8 between = (1.0f - u - v) * a + u * b + v * c;
  const bool is_moved = !(instance->flags & INSTANCE_UNMOVED);
  Surface s;
  s.point = between.s012;
  float3 normal = cross(b.s012 - a.s012, c.s012 - a.s012);
  if (is_moved) {
    s.point = affine_point(instance->to_world, s.point);
    normal = affine_normal(instance->to_object, normal);
  }
  s.face = unit(normal);
  s.shading = s.face;
  if (instance->flags & INSTANCE_NORMALS) {
    const float3 n = is_moved ? affine_normal(instance->to_object, between.s345) : between.s345;
    const float length2 = dot(n, n);
    // normals that cancel say nothing
    if (length2 > 1e-12f) s.shading = n * rsqrt(length2);
  }
  s.uv = between.s67;
  s.second_uv = s.uv;
  return s;
}

// the texture coordinates that a texture's bit of the material's flags asks for
static inline float2 uv_for(const Surface s, const uint flags, const uint bit) {
  return flags & bit ? s.second_uv : s.uv;
}

// second texture coordinates, of meshes that have them
static inline float2 second_uv_of_corner(global const Instance* instance, global const float* second_uvs,
                                         const uint corner) {
  return vload2((uint)(instance->first_second_uv + (int)corner), second_uvs);
}
static inline float2 second_uv_at(global const Instance* instance, global const uint* triangles,
                                  global const float* second_uvs, const uint triangle, const float u, const float v) {
  const uint3 corner = vload3(triangle, triangles);
  return (1.0f - u - v) * second_uv_of_corner(instance, second_uvs, corner.x) +
         u * second_uv_of_corner(instance, second_uvs, corner.y) +
         v * second_uv_of_corner(instance, second_uvs, corner.z);
}

// colour of the vertices between them
static inline float3 vertex_color(global const Instance* instance, global const uint* triangles,
                                  global const float* colors, const uint triangle, const float u, const float v) {
  const uint3 corner = vload3(triangle, triangles) + (uint3)((uint)instance->first_color);
  return (1.0f - u - v) * vload3(corner.x, colors) + u * vload3(corner.y, colors) + v * vload3(corner.z, colors);
}

// The shading normal bent by a normal map; bend: x along growing u, y along falling v, z out; uv: of the triangle's
// corners. Where they have no direction the normal stays.
static inline float3 bent_normal(global const Instance* instance, global const uint* triangles,
                                 global const Vertex* vertices, const uint triangle, const float2 uv[3],
                                 const float3 normal, const float3 bend) {
  const uint3 corner = vload3(triangle, triangles);
  const float3 p = vload3(0, vertices[corner.x].point);
  const float3 e = affine_vector(instance->to_world, vload3(0, vertices[corner.y].point) - p);
  const float3 f = affine_vector(instance->to_world, vload3(0, vertices[corner.z].point) - p);
  const float2 a = uv[1] - uv[0], b = uv[2] - uv[0];
  const float area = a.x * b.y - b.x * a.y;
  if (fabs(area) < 1e-20f) return normal;
  float3 along_u = (b.y * e - a.y * f) / area, along_v = (a.x * f - b.x * e) / area;
  along_u -= normal * dot(normal, along_u);
  along_v -= normal * dot(normal, along_v);
  if (!(dot(along_u, along_u) > 0) || !(dot(along_v, along_v) > 0)) return normal;
  const float3 bent = bend.x * unit(along_u) - bend.y * unit(along_v) + bend.z * normal;
  return dot(bent, bent) > 1e-12f ? unit(bent) : normal;
}

// how far a new ray starts off its surface: more than the rounding of the point and of the change of frames (half a
// micrometre at 1 m), much less than a wall of glass or a contact gap
static inline float ray_offset(const float3 point) {
  return 4e-6f * max(1.0f, max(fabs(point.x), max(fabs(point.y), fabs(point.z))));
}
static inline float3 leave_surface(const float3 point, const float3 normal) {
  return point + normal * ray_offset(point);
}
#endif
