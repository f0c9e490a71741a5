// The drive of a prismatic joint; stiff and with target 0, also each of the two guides that keep it on its line.
#ifndef PVG_ENERGIES_PRISMATIC_DRIVE_H
#define PVG_ENERGIES_PRISMATIC_DRIVE_H
#include "shared/types.h"
SHARED_BEGIN
typedef struct {
  u32 site[3];  // point c_i on the parent, point c_j on the child, unit direction d_i on the parent
  u32 unused;
  f64 stiffness;      // [N/m]
  f64 damping;        // [N s/m]
  f64 target;         // at the end of the step [m]
  f64 target_change;  // over the step [m]
  f64 effort_limit;   // [N]; 0: none
  f64 feed_forward;   // force added to that of the stiffness before it is cut [N]
  f64 play;           // within which a loose drive's stiffness does not act [m]
  f64 cut_damping;    // of a loose drive, within its effort limit [N s/m]
  f64 cut_change;     // over the step, which that damping follows [m]
  f64 unused_;
} PrismaticDrive;
SHARED_SIZE(PrismaticDrive, 96);
ENERGY_TERM(8, prismatic_drive, PrismaticDrive, 3);
SHARED_END
#endif
