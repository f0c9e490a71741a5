// Drive of a revolute joint:  E = V(q),  V: drive_law.cl,  q: the angle of joint_coordinate.cl                      [J]
#include "energies/joint/drive_law.cl"
#include "energies/joint/joint_coordinate.cl"
#include "energies/joint/revolute_drive.h"

static inline real revolute_drive_energy(const RevoluteDrive p, const real3* x, const real3* x0, const real h) {
  const DriveLaw law = DRIVE_LAW_OF(p);
  return drive_energy(law, revolute_coordinate(x, x0, p.angle0), p.angle0, h);
}

static inline void revolute_drive_gradient(const RevoluteDrive p, const real3* x, const real3* x0, const real h,
                                           real3* g) {
  const DriveLaw law = DRIVE_LAW_OF(p);
  const real slope = drive_slope(law, revolute_coordinate(x, x0, p.angle0), p.angle0, h);
  revolute_derivatives(x, g);
  for (int s = 0; s < 4; ++s) g[s] *= slope;
}

static inline void revolute_drive_hessian(const RevoluteDrive p, const real3* x, const real3* x0, const real h,
                                          real* H) {
  const DriveLaw law = DRIVE_LAW_OF(p);
  real3 dq[4];
  revolute_derivatives(x, dq);
  joint_hessian(drive_curvature(law, revolute_coordinate(x, x0, p.angle0), p.angle0, h), 4, dq, H);
}

#define TERM revolute_drive
#define PARAMS RevoluteDrive
#define STENCIL 4
#include "energies/assemble.cl"
