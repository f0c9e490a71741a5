// What a drive does along a joint's coordinate q, the same for angles and lengths. Wanted effort: tau - k (q - target).
//   V(q) = k/2 u^2 where |k u| <= L, else L |u| - L^2 / (2 k)                                       (Huber)
//          u = e - clamp(e, -play / 2, play / 2),   e = q - target - tau / k
//        + c/(2 h) (q - q0 - dtarget)^2,   q0: q at the start of the step
// so the effort is cut at +-L without a jump; for k = 0 it is tau, cut likewise, and V = -tau (q - target).
// Damping is not a part of what is cut.
#ifndef PVG_ENERGIES_DRIVE_LAW_CL
#define PVG_ENERGIES_DRIVE_LAW_CL
#include "shared/real.h"

typedef struct {
  real stiffness;      // k [N m/rad or N/m]
  real damping;        // c [N m s/rad or N s/m]
  real target;         // [rad or m]
  real target_change;  // dtarget, over the step [rad or m]
  real effort_limit;   // L [N m or N]; 0: none
  real feed_forward;   // tau [N m or N]
  real play;           // of a loose drive, which does not act within it [rad or m]
} DriveLaw;

#define DRIVE_LAW_OF(p) \
  { (p).stiffness, (p).damping, (p).target, (p).target_change, (p).effort_limit, (p).feed_forward, (p).play }

static inline real drive_cut(const DriveLaw d, const real effort) {
  return d.effort_limit > 0 ? clamp(effort, -d.effort_limit, d.effort_limit) : effort;
}

// u [rad or m], for k > 0
static inline real drive_strain(const DriveLaw d, const real q) {
  const real e = q - d.target - d.feed_forward / d.stiffness;
  return e - clamp(e, -0.5 * d.play, 0.5 * d.play);
}

static inline real drive_energy(const DriveLaw d, const real q, const real q0, const real h) {
  const real lag = q - q0 - d.target_change;
  const real damped = 0.5 * d.damping / h * lag * lag;
  if (d.stiffness == 0) return damped - drive_cut(d, d.feed_forward) * (q - d.target);
  const real u = drive_strain(d, q), limit = d.effort_limit;
  if (limit > 0 && d.stiffness * fabs(u) > limit) return damped + limit * fabs(u) - 0.5 * limit * limit / d.stiffness;
  return damped + 0.5 * d.stiffness * u * u;
}

// dV/dq: minus the effort
static inline real drive_slope(const DriveLaw d, const real q, const real q0, const real h) {
  const real effort = d.stiffness == 0 ? d.feed_forward : -d.stiffness * drive_strain(d, q);
  return d.damping / h * (q - q0 - d.target_change) - drive_cut(d, effort);
}

// Curvature for Newton's method: d2V/dq2 where the effort is not cut. Where it is, V is straight and d2V/dq2 = 0 would
// send the joint off without bound; the secant V'(u) / u = L / |u| bounds V from above instead (iteratively reweighted
// least squares).
static inline real drive_curvature(const DriveLaw d, const real q, const real q0, const real h) {
  if (d.stiffness == 0) return d.damping / h;
  const real u = fabs(drive_strain(d, q));
  if (u == 0 && d.play > 0) return d.damping / h;
  const bool is_cut = d.effort_limit > 0 && d.stiffness * u > d.effort_limit;
  return d.damping / h + (is_cut ? d.effort_limit / u : d.stiffness);
}

#endif
