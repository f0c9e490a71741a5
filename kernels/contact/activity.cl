// Which candidates exert a force, and how many of each 64: from these numbers contacts are listed (fill_contacts in
// contact/contact.cl) without a prefix sum in launches of its own.
#ifndef PVG_CONTACT_ACTIVITY_CL
#define PVG_CONTACT_ACTIVITY_CL
#include "shared/types.h"

// The number of a work-group's work-items that are active, for each of them.  count: one number that all of them share
static inline uint count_active(const bool is_active, local uint* count) {
  if (get_local_id(0) == 0) *count = 0;
  barrier(CLK_LOCAL_MEM_FENCE);
  if (is_active) atomic_inc(count);
  barrier(CLK_LOCAL_MEM_FENCE);
  return *count;
}

#endif
