// From places of a camera's picture to directions and from points to places.
#include "sensors/camera.cl"

// pixels: [n x 2] from the middle of the first pixel;  directions: [n x 3] unit, in the world; 0: nothing is seen there
kernel void pixel_rays(const uint n, const PinholeCamera camera, global const float* restrict pixels,
                       global float* restrict directions) {
  const uint i = get_global_id(0);
  if (i >= n) return;
  float3 direction;
  const bool is_seen = pixel_direction(camera, vload2(i, pixels), &direction);
  vstore3(is_seen ? normalize(camera_vector(camera, direction)) : (float3)(0.0f), i, directions);
}

// points: [n x 3, m] of the world;  pixels: [n x 2] from the middle of the first one; -1: the camera does not see behind
// itself
kernel void point_pixels(const uint n, const PinholeCamera camera, global const float* restrict points,
                         global float* restrict pixels) {
  const uint i = get_global_id(0);
  if (i >= n) return;
  float2 pixel;
  const bool is_seen = project(camera, in_camera(camera, vload3(i, points)), &pixel);
  vstore2(is_seen ? pixel : (float2)(-1.0f), i, pixels);
}
