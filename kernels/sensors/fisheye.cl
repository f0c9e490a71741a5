// OpenCV's fisheye camera (Kannala and Brandt 2006): a direction at the angle theta from the optical axis is seen at
//   theta_d = theta (1 + k1 theta^2 + k2 theta^4 + k3 theta^6 + k4 theta^8)
// from the centre, in units of the focal length. The ray of a pixel inverts this by Newton's method.
#ifndef PVG_SENSORS_FISHEYE_CL
#define PVG_SENSORS_FISHEYE_CL
#include "render/path.h"

#define FISHEYE_ITERATIONS 12
#define FISHEYE_TOLERANCE 1e-5f

static inline float fisheye_radius(const PinholeCamera c, const float theta) {
  const float t = theta * theta;
  return theta * (1.0f + t * (c.k[0] + t * (c.k[1] + t * (c.k[2] + t * c.k[3]))));
}

// false: nothing is seen there (beyond half a turn, or where the polynomial turns back)
static inline bool fisheye_direction(const PinholeCamera c, const float2 seen, float3* direction) {
  const float radius = length(seen);
  float theta = radius;
  for (int i = 0; i < FISHEYE_ITERATIONS; ++i) {
    const float t = theta * theta;
    const float slope =
        1.0f + t * (3.0f * c.k[0] + t * (5.0f * c.k[1] + t * (7.0f * c.k[2] + t * 9.0f * c.k[3])));
    if (!(slope > 1e-6f)) return false;
    theta -= (fisheye_radius(c, theta) - radius) / slope;
  }
  if (!(theta >= 0 && theta < M_PI_F) || !(fabs(fisheye_radius(c, theta) - radius) <= FISHEYE_TOLERANCE)) return false;
  const float across = radius > 1e-8f ? sin(theta) / radius : 1.0f;
  *direction = (float3)(seen.x * across, seen.y * across, cos(theta));
  return true;
}

// d: in the camera's frame, not zero
static inline float2 fisheye_project(const PinholeCamera c, const float3 d) {
  const float across = length(d.xy), theta = atan2(across, d.z);
  return d.xy * (across > 1e-12f ? fisheye_radius(c, theta) / across : 0.0f);
}
#endif
