// What a drive does along a joint's coordinate q, the same for angles and lengths. Wanted effort: tau - k (q - target).
//   V(q) = k/2 u^2 where |k u| <= L, else L |u| - L^2 / (2 k)                                       (Huber)
//          u = e - clamp(e, -play / 2, play / 2),   e = q - target - tau / k
//        + c/(2 h) (q - q0 - dtarget)^2,   q0: q at the start of the step
// so the effort is cut at +-L without a jump; for k = 0 it is tau, cut likewise, and V = -tau (q - target).
// c is the joint's own damping and armature, which no drive limits. That of the drive itself is a part of k, target and
// tau (host/physics/energies/joint.hpp), and so of what is cut. A loose drive (play > 0) has it beside, as b:
//   V'(q) = cut(k u + b/h (q - q0 - dcut)) + c/h (q - q0 - dtarget)
// k u + ... ascends by straight pieces; where it crosses +-L, V goes on as a straight line.
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
  real play;           // of a loose drive, whose stiffness does not act within it [rad or m]
  real cut_damping;    // b, of a loose drive: within its limit [N m s/rad or N s/m]
  real cut_change;     // dcut, over the step, which that damping follows [rad or m]
} DriveLaw;

#define DRIVE_LAW_OF(p) \
  { (p).stiffness, (p).damping, (p).target, (p).target_change, (p).effort_limit, (p).feed_forward, (p).play, \
    (p).cut_damping, (p).cut_change }

static inline real drive_cut(const DriveLaw d, const real effort) {
  return d.effort_limit > 0 ? clamp(effort, -d.effort_limit, d.effort_limit) : effort;
}

// u [rad or m], for k > 0
static inline real drive_strain(const DriveLaw d, const real q) {
  const real e = q - d.target - d.feed_forward / d.stiffness;
  return e - clamp(e, -0.5 * d.play, 0.5 * d.play);
}

// of a loose drive with damping, k > 0: minus its effort before it is cut
static inline real loose_pull(const DriveLaw d, const real q, const real q0, const real h) {
  return d.stiffness * drive_strain(d, q) + d.cut_damping / h * (q - q0 - d.cut_change);
}

// where loose_pull is `pull`
static inline real loose_position(const DriveLaw d, const real pull, const real q0, const real h) {
  const real b = d.cut_damping / h, rest = q0 + d.cut_change, k = d.stiffness;
  const real middle = d.target + d.feed_forward / k, low = middle - 0.5 * d.play, high = middle + 0.5 * d.play;
  if (pull < b * (low - rest)) return (pull + k * low + b * rest) / (k + b);
  if (pull > b * (high - rest)) return (pull + k * high + b * rest) / (k + b);
  return rest + pull / b;
}

static inline real loose_energy(const DriveLaw d, const real q, const real q0, const real h) {
  const real limit = d.effort_limit;
  real at = q;
  if (limit > 0) at = clamp(q, loose_position(d, -limit, q0, h), loose_position(d, limit, q0, h));
  const real u = drive_strain(d, at), lag = at - q0 - d.cut_change;
  return 0.5 * d.stiffness * u * u + 0.5 * d.cut_damping / h * lag * lag + limit * fabs(q - at);
}

static inline real drive_energy(const DriveLaw d, const real q, const real q0, const real h) {
  const real lag = q - q0 - d.target_change;
  const real damped = 0.5 * d.damping / h * lag * lag;
  if (d.stiffness == 0) return damped - drive_cut(d, d.feed_forward) * (q - d.target);
  if (d.cut_damping > 0) return damped + loose_energy(d, q, q0, h);
  const real u = drive_strain(d, q), limit = d.effort_limit;
  if (limit > 0 && d.stiffness * fabs(u) > limit) return damped + limit * fabs(u) - 0.5 * limit * limit / d.stiffness;
  return damped + 0.5 * d.stiffness * u * u;
}

// dV/dq: minus the effort
static inline real drive_slope(const DriveLaw d, const real q, const real q0, const real h) {
  if (d.stiffness > 0 && d.cut_damping > 0)
    return d.damping / h * (q - q0 - d.target_change) + drive_cut(d, loose_pull(d, q, q0, h));
  const real effort = d.stiffness == 0 ? d.feed_forward : -d.stiffness * drive_strain(d, q);
  return d.damping / h * (q - q0 - d.target_change) - drive_cut(d, effort);
}

// Curvature for Newton's method: d2V/dq2 where the effort is not cut. Where it is, V is straight and d2V/dq2 = 0 would
// send the joint off without bound; the secant V'(u) / u = L / |u| bounds V from above instead (iteratively reweighted
// least squares).
static inline real drive_curvature(const DriveLaw d, const real q, const real q0, const real h) {
  if (d.stiffness == 0) return d.damping / h;
  const real u = fabs(drive_strain(d, q));
  if (d.cut_damping > 0) {
    const real pull = fabs(loose_pull(d, q, q0, h));
    if (d.effort_limit > 0 && pull > d.effort_limit)
      return d.damping / h + d.effort_limit / fabs(q - loose_position(d, 0, q0, h));
    return (d.damping + d.cut_damping) / h + (u > 0 ? d.stiffness : 0);
  }
  if (u == 0 && d.play > 0) return d.damping / h;
  const bool is_cut = d.effort_limit > 0 && d.stiffness * u > d.effort_limit;
  return d.damping / h + (is_cut ? d.effort_limit / u : d.stiffness);
}

#endif
