// OpenCV's pinhole camera with distortion. A point (x, y, 1) of the camera's frame is seen at
//   x'' = x r + 2 p1 x y + p2 (r2 + 2 x^2),  y'' = y r + p1 (r2 + 2 y^2) + 2 p2 x y,  r2 = x^2 + y^2,
//   r = (1 + k1 r2 + k2 r2^2 + k3 r2^3) / (1 + k4 r2 + k5 r2^2 + k6 r2^3),
//   pixel = (fx x'' + cx, fy y'' + cy), pixel (0, 0) being the centre of the top left one.
// The ray of a pixel inverts this by Newton's method. k = k1 k2 k3 k4 k5 k6.
#ifndef PVG_SENSORS_PINHOLE_CL
#define PVG_SENSORS_PINHOLE_CL
#include "render/path.h"

#define UNDISTORT_ITERATIONS 12
#define UNDISTORT_TOLERANCE 1e-5f

static inline float2 distort(const PinholeCamera c, const float2 q) {
  const float r2 = dot(q, q);
  const float radial =
      (1.0f + r2 * (c.k[0] + r2 * (c.k[1] + r2 * c.k[2]))) / (1.0f + r2 * (c.k[3] + r2 * (c.k[4] + r2 * c.k[5])));
  return (float2)(q.x * radial + 2.0f * c.p[0] * q.x * q.y + c.p[1] * (r2 + 2.0f * q.x * q.x),
                  q.y * radial + c.p[0] * (r2 + 2.0f * q.y * q.y) + 2.0f * c.p[1] * q.x * q.y);
}

// false: no point of the scene is seen there (beyond the turning point of the distortion)
static inline bool undistort(const PinholeCamera c, const float2 seen, float2* point) {
  float2 q = seen;
  float2 residual = distort(c, q) - seen;
  for (int i = 0; i < UNDISTORT_ITERATIONS; ++i) {
    // differences are exact enough for the slope: the residual decides
    const float h = 1e-3f;
    const float2 dx = (distort(c, q + (float2)(h, 0)) - distort(c, q - (float2)(h, 0))) / (2 * h);
    const float2 dy = (distort(c, q + (float2)(0, h)) - distort(c, q - (float2)(0, h))) / (2 * h);
    const float det = dx.x * dy.y - dy.x * dx.y;
    if (!(det > 1e-6f)) return false;
    q -= (float2)(dy.y * residual.x - dy.x * residual.y, dx.x * residual.y - dx.y * residual.x) / det;
    residual = distort(c, q) - seen;
  }
  *point = q;
  return dot(residual, residual) <= UNDISTORT_TOLERANCE * UNDISTORT_TOLERANCE;
}

#endif
