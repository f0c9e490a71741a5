// From pixels to directions and back, whatever the camera's model.
#ifndef PVG_SENSORS_CAMERA_CL
#define PVG_SENSORS_CAMERA_CL
#include "sensors/fisheye.cl"
#include "sensors/pinhole.cl"

// direction in the camera's frame, of any length; false: nothing is seen there
static inline bool pixel_direction(const PinholeCamera c, const float2 pixel, float3* direction) {
  const float2 seen = (float2)((pixel.x - c.cx) / c.fx, (pixel.y - c.cy) / c.fy);
  if (c.model == CAMERA_FISHEYE) return fisheye_direction(c, seen, direction);
  float2 q = seen;
  if (c.is_distorted && !undistort(c, seen, &q)) return false;
  *direction = (float3)(q, 1.0f);
  return true;
}

// p: in the camera's frame [m]; false: a pinhole camera does not see behind itself
static inline bool project(const PinholeCamera c, const float3 p, float2* pixel) {
  float2 seen;
  if (c.model == CAMERA_FISHEYE) {
    seen = fisheye_project(c, p);
  } else {
    if (p.z <= 0) return false;
    seen = c.is_distorted ? distort(c, p.xy / p.z) : p.xy / p.z;
  }
  *pixel = (float2)(c.fx * seen.x + c.cx, c.fy * seen.y + c.cy);
  return true;
}

static inline float3 camera_vector(const PinholeCamera c, const float3 v) {
  return (float3)(c.to_world[0] * v.x + c.to_world[1] * v.y + c.to_world[2] * v.z,
                  c.to_world[4] * v.x + c.to_world[5] * v.y + c.to_world[6] * v.z,
                  c.to_world[8] * v.x + c.to_world[9] * v.y + c.to_world[10] * v.z);
}

// a point of the world in the camera's frame; the axes are orthonormal
static inline float3 in_camera(const PinholeCamera c, const float3 world) {
  const float3 v = world - (float3)(c.to_world[3], c.to_world[7], c.to_world[11]);
  return (float3)(c.to_world[0] * v.x + c.to_world[4] * v.y + c.to_world[8] * v.z,
                  c.to_world[1] * v.x + c.to_world[5] * v.y + c.to_world[9] * v.z,
                  c.to_world[2] * v.x + c.to_world[6] * v.y + c.to_world[10] * v.z);
}
#endif
