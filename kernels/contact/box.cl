// Boxes of what moves straight from x0 to x1, in single precision, rounded outward.
#ifndef PVG_CONTACT_BOX_CL
#define PVG_CONTACT_BOX_CL
#include "shared/real.h"

typedef struct {
  float3 low, high;
} Box;

static inline Box empty_box() {
  const Box box = {(float3)(INFINITY), (float3)(-INFINITY)};
  return box;
}

static inline Box box_of_site(const uint site, global const real* restrict x0, global const real* restrict x1,
                              const Box box) {
  const real3 a = vload3(site, x0), b = vload3(site, x1);
  const Box grown = {fmin(box.low, convert_float3(fmin(a, b))), fmax(box.high, convert_float3(fmax(a, b)))};
  return grown;
}

// rounding to float moved the box by less than 2^-24 of its coordinates; 2^-22 outward covers it and the margin's own
static inline Box grow(const Box box, const real margin) {
  const float m = (float)margin * 1.000001f;
  const Box grown = {box.low - m - (fabs(box.low) + m) * 2.4e-7f, box.high + m + (fabs(box.high) + m) * 2.4e-7f};
  return grown;
}

#endif
