// Textures: 8-bit texels of all textures in one buffer, sRGB colours or plain values, filtered linearly in linear
// colour, repeated. By hand, because image samplers of CPU drivers take twice as long. decode: byte to linear [512],
// first sRGB's (IEC 61966-2-1), then i / 255.
#ifndef PVG_MATERIALS_TEXTURE_CL
#define PVG_MATERIALS_TEXTURE_CL
#include "materials/material.h"

static inline float3 texel(global const uchar4* texels, constant float* decode, const uint i) {
  const uchar4 c = texels[i];
  return (float3)(decode[c.x], decode[c.y], decode[c.z]);
}

// the four texels around a point, and how far it is from the first to the next ones
typedef struct {
  uint top_left, top_right, bottom_left, bottom_right;
  float right, down;
} TexelSquare;

// uv: (0, 0) is the outer corner of the first texel of the top row
static inline TexelSquare texel_square(const TextureInfo info, const float2 uv) {
  const float x = (uv.x - floor(uv.x)) * (float)info.width - 0.5f, y = (uv.y - floor(uv.y)) * (float)info.height - 0.5f;
  const float x_floor = floor(x), y_floor = floor(y);
  const uint x0 = x_floor < 0 ? info.width - 1 : min((uint)x_floor, info.width - 1);
  const uint y0 = y_floor < 0 ? info.height - 1 : min((uint)y_floor, info.height - 1);
  const uint x1 = x0 + 1 == info.width ? 0 : x0 + 1, y1 = y0 + 1 == info.height ? 0 : y0 + 1;
  const uint row0 = info.first + y0 * info.width, row1 = info.first + y1 * info.width;
  const TexelSquare s = {row0 + x0, row0 + x1, row1 + x0, row1 + x1, x - x_floor, y - y_floor};
  return s;
}

static inline float3 texture_color(const TextureInfo info, global const uchar4* texels, constant float* decode_bytes,
                                   const float2 uv) {
  constant float* decode = decode_bytes + (info.is_linear ? 256 : 0);
  const TexelSquare s = texel_square(info, uv);
  const float3 top = mix(texel(texels, decode, s.top_left), texel(texels, decode, s.top_right), s.right);
  const float3 bottom = mix(texel(texels, decode, s.bottom_left), texel(texels, decode, s.bottom_right), s.right);
  return mix(top, bottom, s.down);
}

// alpha, a plain value, 0 to 1
static inline float texture_alpha(const TextureInfo info, global const uchar4* texels, const float2 uv) {
  const TexelSquare s = texel_square(info, uv);
  const float top = mix((float)texels[s.top_left].w, (float)texels[s.top_right].w, s.right);
  const float bottom = mix((float)texels[s.bottom_left].w, (float)texels[s.bottom_right].w, s.right);
  return mix(top, bottom, s.down) / 255.0f;
}
#endif
