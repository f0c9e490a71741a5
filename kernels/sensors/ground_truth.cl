// What is exactly at the middle of each pixel: depth along the optical axis, instance and normal. Glass is a surface
// like any other; no mixing at edges.
#include "render/surface.cl"
#include "render/tiles.cl"

// hit, hit_instance: [n_pixels] of rays with z = 1 in the camera's frame;  throughput: 0 where the camera sees nothing;
// depth: [height x width, m], infinite: nothing;  instance: [height x width] 1 + index of the Visual, 0: none or a
// light; normal: [height x width x 3] unit, world, toward the camera, or 0
kernel void ground_truth(const uint n_pixels, const Launch launch, global const Instance* restrict instances,
                         global const uint* restrict triangles, global const Vertex* restrict vertices,
                         global const float4* restrict hit, global const uint* restrict hit_instance,
                         global const float4* restrict direction, global const float4* restrict throughput,
                         global float* restrict depth, global uint* restrict instance, global float* restrict normal) {
  const uint i = get_global_id(0);
  if (i >= n_pixels) return;
  const uint2 pixel = tile_pixel(launch.first_pixel + i, launch.camera.width, launch.camera.height);
  const uint at = pixel.y * launch.camera.width + pixel.x;
  const float4 h = hit[i];
  if (as_uint(h.w) == NO_TRIANGLE || throughput[i].x == 0) {
    depth[at] = INFINITY;
    instance[at] = 0;
    vstore3((float3)(0.0f), at, normal);
    return;
  }
  global const Instance* seen = instances + hit_instance[i];
  const Surface s = surface_at(seen, triangles, vertices, as_uint(h.w), h.y, h.z);
  depth[at] = h.x;
  instance[at] = seen->visual;
  vstore3(dot(s.shading, direction[i].xyz) < 0 ? s.shading : -s.shading, at, normal);
}
