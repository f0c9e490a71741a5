// The surroundings as a picture: longitude along its width, latitude along its height, z up at the top, +x in the
// middle, +y to the left. Directions are drawn from a coarse grid of cells by their power with an alias table (Vose
// 1991), evenly within a cell; every cell keeps a little, so that no light is missed.
#ifndef PVG_RENDER_ENVIRONMENT_CL
#define PVG_RENDER_ENVIRONMENT_CL
#include "render/path.h"

static inline float2 environment_uv(const Launch launch, const float3 d) {
  const float u = 0.5f - (atan2(d.y, d.x) - launch.environment_turn) * (0.5f * M_1_PI_F);
  return (float2)(u - floor(u), acos(clamp(d.z, -1.0f, 1.0f)) * M_1_PI_F);
}

// texels: [height x width x 3, W/(sr m^2)], linear between their centres; d: unit
static inline float3 environment_radiance(const Launch launch, global const float* texels, const float3 d) {
  const float3 scale = vload3(0, launch.environment);
  const uint w = launch.environment_width, h = launch.environment_height;
  if (w == 0) return scale;
  const float2 uv = environment_uv(launch, d);
  const float x = uv.x * (float)w - 0.5f, y = clamp(uv.y * (float)h - 0.5f, 0.0f, (float)(h - 1));
  const float x_floor = floor(x), y_floor = floor(y);
  const uint x0 = x_floor < 0 ? w - 1 : min((uint)x_floor, w - 1), x1 = x0 + 1 == w ? 0 : x0 + 1;
  const uint y0 = (uint)y_floor, y1 = min(y0 + 1, h - 1);
  const float a = x - x_floor, b = y - y_floor;
  const float3 top = mix(vload3(y0 * w + x0, texels), vload3(y0 * w + x1, texels), a);
  const float3 bottom = mix(vload3(y1 * w + x0, texels), vload3(y1 * w + x1, texels), a);
  return scale * mix(top, bottom, b);
}

// density over directions [1/sr]
static inline float environment_pdf(const Launch launch, global const EnvironmentCell* cells, const float3 d) {
  const float2 uv = environment_uv(launch, d);
  const float w = ENVIRONMENT_COLUMNS, h = ENVIRONMENT_ROWS;
  const uint i = min((uint)(uv.x * w), ENVIRONMENT_COLUMNS - 1), k = min((uint)(uv.y * h), ENVIRONMENT_ROWS - 1);
  return cells[k * ENVIRONMENT_COLUMNS + i].density;
}

// choice: uniform, apart from u
static inline float3 environment_sample(const Launch launch, global const EnvironmentCell* cells, const float2 u,
                                        const float choice) {
  const float place = u.x * (float)(ENVIRONMENT_COLUMNS * ENVIRONMENT_ROWS);
  uint cell = min((uint)place, ENVIRONMENT_COLUMNS * ENVIRONMENT_ROWS - 1);
  const float across = clamp(place - (float)cell, 0.0f, 0x1.fffffep-1f);
  if (choice >= cells[cell].keep) cell = cells[cell].other;
  const uint i = cell % ENVIRONMENT_COLUMNS, k = cell / ENVIRONMENT_COLUMNS;
  // evenly in longitude and in the sine of latitude: evenly in solid angle
  const float longitude = (0.5f - ((float)i + across) / ENVIRONMENT_COLUMNS) * 2.0f * M_PI_F + launch.environment_turn;
  const float high = cos(M_PI_F * (float)k / ENVIRONMENT_ROWS), low = cos(M_PI_F * (float)(k + 1) / ENVIRONMENT_ROWS);
  const float z = mix(high, low, u.y), r = sqrt(max(0.0f, 1.0f - z * z));
  return (float3)(r * cos(longitude), r * sin(longitude), z);
}
#endif
