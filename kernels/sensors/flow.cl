// Optical flow: where the point that a pixel showed is in another picture, after everything has moved, and whether it is
// seen there. What no surface covers is infinitely far away and moves with the camera's turning alone.
#include "render/cutout.cl"
#include "sensors/camera.cl"

#define POINT_SEEN 0
#define POINT_HIDDEN 1   // something is before it
#define POINT_OUTSIDE 2  // beyond the picture's border, or behind the camera

// a hit further away than this share of the distance is the point itself
#define SAME_POINT 0.998f

// from: the picture that showed the points, to: the other one, whose scene the buffers hold;  seen: as in
// ground_truth.cl, of `from`;  flow: [height x width x 2, pixels], 0 where nothing can be said;  state: [height x width]
kernel void flow(const uint n_pixels, const Launch from, const Launch to, global const float8* restrict top,
                 global const float8* restrict nodes, global const float4* restrict blocks,
                 global const Instance* restrict instances, global const Material* restrict materials,
                 global const TextureInfo* restrict textures, global const uchar4* restrict texels,
                 global const uint* restrict triangles, global const Vertex* restrict vertices,
                 global const float* restrict second_uvs, global const float4* restrict seen, global float* restrict flow, global uchar* restrict state) {
  const uint at = get_global_id(0);
  if (at >= n_pixels) return;
  const PinholeCamera a = from.camera, b = to.camera;
  const float2 pixel = (float2)((float)(at % a.width), (float)(at / a.width));
  vstore2((float2)(0.0f), at, flow);
  state[at] = POINT_OUTSIDE;
  const float4 place = seen[at];
  float3 point;
  if (as_uint(place.z) == NO_TRIANGLE) {
    float3 d;
    if (!pixel_direction(a, pixel, &d)) return;
    point = (float3)(b.to_world[3], b.to_world[7], b.to_world[11]) + 1e5f * normalize(camera_vector(a, d));
  } else {
    point = surface_at(instances + as_uint(place.w), triangles, vertices, as_uint(place.z), place.x, place.y).point;
  }
  float2 moved;
  if (!project(b, in_camera(b, point), &moved)) return;
  vstore2(moved - pixel, at, flow);
  if (moved.x < -0.5f || moved.y < -0.5f || moved.x >= (float)b.width - 0.5f || moved.y >= (float)b.height - 0.5f)
    return;
  const Trees trees = {top, nodes, blocks, instances};
  const float3 eye = (float3)(b.to_world[3], b.to_world[7], b.to_world[11]);
  Hit hit = {SAME_POINT, 0, 0, NO_TRIANGLE, 0};
  const Cutouts cutouts = {instances, materials, textures, texels, triangles, vertices, second_uvs};
  closest_solid_hit(trees, cutouts, eye, point - eye, &hit);
  state[at] = hit.triangle == NO_TRIANGLE || hit.triangle == as_uint(place.z) ? POINT_SEEN : POINT_HIDDEN;
}
