// real: the number type of the physics kernels. Energies, collision detection and the residual are in double
// precision; a device without cl_khr_fp64 is refused by the host. Device only.
#ifndef PVG_SHARED_REAL_H
#define PVG_SHARED_REAL_H
#pragma OPENCL EXTENSION cl_khr_fp64 : enable
typedef double real;
typedef double2 real2;
typedef double3 real3;
typedef double4 real4;
#endif
