// The solids that a camera is inside of: those that a ray from it leaves without having entered them, the innermost
// first (media.cl).
#include "render/media.cl"
#include "render/surface.cl"

#define MOST_CROSSINGS 256

// one work-item; direction: any;  media: [1]
kernel void camera_media(const Launch launch, global const float8* restrict top, global const float8* restrict nodes,
                         global const float4* restrict blocks, global const Instance* restrict instances,
                         global const Material* restrict materials, global const uint* restrict triangles,
                         global const Vertex* restrict vertices, global uint* restrict media) {
  if (get_global_id(0) > 0) return;
  const Trees trees = {top, nodes, blocks, instances};
  const PinholeCamera c = launch.camera;
  float3 origin = (float3)(c.to_world[3], c.to_world[7], c.to_world[11]);
  // not along an axis, where edges of boxes and spheres lie
  const float3 direction = normalize((float3)(0.1234f, 0.0567f, 0.9871f));
  uint entered = 0, inside = 0, n_inside = 0;
  for (int i = 0; i < MOST_CROSSINGS && n_inside < 4; ++i) {
    Hit h = {INFINITY, 0, 0, NO_TRIANGLE, 0};
    closest_hit(trees, origin, direction, &h);
    if (h.triangle == NO_TRIANGLE) break;
    global const Instance* instance = instances + h.instance;
    const Surface s = surface_at(instance, triangles, vertices, h.triangle, h.u, h.v);
    origin = leave_surface(s.point, dot(s.face, direction) > 0 ? s.face : -s.face);
    if (instance->visual == 0 || !(materials[instance->material].flags & MATERIAL_HAS_INSIDE)) continue;
    const uint material = instance->material;
    if (dot(s.face, direction) < 0)
      entered = media_enter(entered, material);
    else if (media_holds(entered, material))
      entered = media_leave(entered, material);
    else
      inside |= (material + 1) << (8 * n_inside++);
  }
  media[0] = inside;
}
