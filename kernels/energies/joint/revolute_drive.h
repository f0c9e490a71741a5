// The drive of a revolute joint.
#ifndef PVG_ENERGIES_REVOLUTE_DRIVE_H
#define PVG_ENERGIES_REVOLUTE_DRIVE_H
#include "shared/types.h"
SHARED_BEGIN
typedef struct {
  u32 site[4];        // directions n_i, b_i on the parent, n_j, b_j on the child; b = axis x n; equal at q = 0
  f64 stiffness;      // [N m/rad]
  f64 damping;        // [N m s/rad]
  f64 target;         // at the end of the step [rad]
  f64 target_change;  // over the step [rad]
  f64 effort_limit;   // [N m]; 0: none
  f64 feed_forward;   // torque added to that of the stiffness before it is cut [N m]
  f64 angle0;         // q at the start of the step, whole turns included [rad]
  f64 play;           // within which a loose drive's stiffness does not act [rad]
  f64 cut_damping;    // of a loose drive, within its effort limit [N m s/rad]
  f64 cut_change;     // over the step, which that damping follows [rad]
} RevoluteDrive;
SHARED_SIZE(RevoluteDrive, 96);
ENERGY_TERM(7, revolute_drive, RevoluteDrive, 4);
SHARED_END
#endif
