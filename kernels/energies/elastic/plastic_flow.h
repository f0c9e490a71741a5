// An element whose rest shape follows its strain.
#ifndef PVG_ENERGIES_PLASTIC_FLOW_H
#define PVG_ENERGIES_PLASTIC_FLOW_H
#include "shared/types.h"
SHARED_BEGIN
typedef struct {
  u32 element;  // of its term
  u32 world;
  f64 yield_strain;  // |dev log U| beyond which it flows at once; 0: does not
  f64 rate;          // at which it flows at any strain [1/s]
  f64 unused;
} PlasticFlow;
SHARED_SIZE(PlasticFlow, 32);
SHARED_END
#endif
