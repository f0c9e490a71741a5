// Stage 1 on a CPU, sixteen paths at a time: what generate.cl does. Rays of pinhole cameras without distortion and lens
// are made side by side.
#ifndef PVG_RENDER_LANES_START_CL
#define PVG_RENDER_LANES_START_CL
#define PATHS PACKET
#include "render/generate.cl"
#include "render/lanes/rows.cl"

// a pinhole camera without distortion and lens
static inline bool is_plain(const PinholeCamera* c) {
  return c->model == CAMERA_PINHOLE && !c->is_distorted && c->lens_radius == 0;
}

// start_paths() of such a camera, with the same bits
static inline void start_plain_paths(const Launch* launch, global const uint* pixels, const uint first, const uint n,
                                     const uint first_slot, const Slots* slots) {
  const PinholeCamera* c = &launch->camera;
  uint pixel[PATHS], key[PATHS], sample[PATHS], slot[PATHS];
  number_paths(*launch, pixels, first, n, pixel, key, sample);
  for (uint k = 0; k < PATHS; ++k) slot[k] = first_slot + min(k, n - 1 - first);
  const uint16 place = vload16(0, pixel), y_place = place / c->width;
  float16 x = convert_float16(place - y_place * c->width), y = convert_float16(y_place);
  if (!launch->is_center) {
    float16 in_x, in_y;
    sample_2d_16(vload16(0, key), vload16(0, sample), 0, &in_x, &in_y);
    x += in_x - 0.5f;
    y += in_y - 0.5f;
  }
  const float16 dx = (x - c->cx) / c->fx, dy = (y - c->cy) / c->fy;
  const Packet d = {c->to_world[0] * dx + c->to_world[1] * dy + c->to_world[2],
                    c->to_world[4] * dx + c->to_world[5] * dy + c->to_world[6],
                    c->to_world[8] * dx + c->to_world[9] * dy + c->to_world[10]};
  float16 length2;
  {
    // as normalize() of PoCL: other roundings would send some paths elsewhere
#pragma OPENCL FP_CONTRACT OFF
    length2 = d.x * d.x + d.y * d.y + d.z * d.z;
  }
  const Packet from = packet_of((float3)(c->to_world[3], c->to_world[7], c->to_world[11]));
  const float16 zero = sixteen(0.0f);
  const Packet one = {sixteen(1.0f), sixteen(1.0f), sixteen(1.0f)}, none = {zero, zero, zero};
  store_rows(rows_of(from, zero), slots->origin, slot);
  store_rows(rows_of(times(d, 1.0f / sqrt(length2)), as_float16((uint16)(launch->media))), slots->direction, slot);
  store_rows(rows_of(one, as_float16((uint16)(0u))), slots->throughput, slot);
  store_rows(rows_of(none, zero), slots->radiance, slot);
  for (uint k = 0; k < PACKET; ++k) {
    slots->stream[slot[k]] = (uint2)(key[k], sample[k]);
    slots->queue[slot[k]] = slot[k];
  }
}

// the paths first .. first + n_here - 1 of the n of a launch, in the first slots
OUT_OF_LINE void start_chunk(const Launch* launch, global const uint* pixels, const uint first, const uint n_here,
                             const uint n, const Slots* slots) {
  const bool plain = is_plain(&launch->camera);
  for (uint k = 0; k < n_here; k += PATHS)
    if (plain)
      start_plain_paths(launch, pixels, first + k, n, k, slots);
    else
      start_paths(*launch, pixels, first + k, n, k, *slots);
}
#endif
