// What is told of one contact.
#ifndef PVG_CONTACT_REPORT_H
#define PVG_CONTACT_REPORT_H
#include "shared/types.h"
SHARED_BEGIN
typedef struct {
  f64 point[3];      // midway between the closest points, world [m]
  f64 normal[3];     // unit, from the second body to the first
  f64 gap;           // [m]
  f64 normal_force;  // [N], >= 0
} ContactReport;
SHARED_SIZE(ContactReport, 64);
SHARED_END
#endif
