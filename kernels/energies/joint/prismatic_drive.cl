// Drive of a prismatic joint:  E = V(q),  V: drive_law.cl,  q = (c_j - c_i) . d_i                                   [J]
#include "energies/joint/drive_law.cl"
#include "energies/joint/joint_coordinate.cl"
#include "energies/joint/prismatic_drive.h"

static inline real prismatic_drive_energy(const PrismaticDrive p, const real3* x, const real3* x0, const real h) {
  const DriveLaw law = DRIVE_LAW_OF(p);
  return drive_energy(law, prismatic_coordinate(x), prismatic_coordinate(x0), h);
}

static inline void prismatic_drive_gradient(const PrismaticDrive p, const real3* x, const real3* x0, const real h,
                                            real3* g) {
  const DriveLaw law = DRIVE_LAW_OF(p);
  const real slope = drive_slope(law, prismatic_coordinate(x), prismatic_coordinate(x0), h);
  prismatic_derivatives(x, g);
  for (int s = 0; s < 3; ++s) g[s] *= slope;
}

static inline void prismatic_drive_hessian(const PrismaticDrive p, const real3* x, const real3* x0, const real h,
                                           real* H) {
  const DriveLaw law = DRIVE_LAW_OF(p);
  real3 dq[3];
  prismatic_derivatives(x, dq);
  joint_hessian(drive_curvature(law, prismatic_coordinate(x), prismatic_coordinate(x0), h), 3, dq, H);
}

#define TERM prismatic_drive
#define PARAMS PrismaticDrive
#define STENCIL 3
#include "energies/assemble.cl"
