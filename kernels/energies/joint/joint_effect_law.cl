// What friction and springs of a joint do along its coordinate q, v = (q - q0) / h its rate, q0 and h those of its row:
//   V(q) = k q^2 / 2 - P q + c v^2 h / 2 + h R(v)
//   R'(v) = (T + S exp(-(w / u)^2)) s(v),   w = max(|v|, eps),   s(v) = sign(v) (2 - |v| / eps) |v| / eps for |v| <
//   eps,
//           else sign(v)
// Coulomb friction T with the Stribeck effect S, u: it sticks at T + S and slides at T. R in closed form by the error
// function. R'' is what it is where it sticks; where it slides R'' is not above zero, and zero stands for it.
#ifndef PVG_ENERGIES_JOINT_EFFECT_LAW_CL
#define PVG_ENERGIES_JOINT_EFFECT_LAW_CL
#include "energies/contact/smooth_coulomb.cl"

typedef struct {
  real stiffness;          // k [N m/rad or N/m]
  real preload;            // P [N m or N]
  real damping;            // c [N m s/rad or N s/m]
  real coulomb;            // T [N m or N]
  real extra;              // S [N m or N]
  real stribeck_velocity;  // u [rad/s or m/s]
  real velocity;           // eps [rad/s or m/s]
} JointEffectLaw;

#define JOINT_EFFECT_LAW_OF(p) \
  { (p).stiffness, (p).preload, (p).damping, (p).coulomb, (p).extra, (p).stribeck_velocity, (p).velocity }

// friction once it slides at v >= eps [N m or N]
static inline real joint_sliding_friction(const JointEffectLaw d, const real v) {
  return d.coulomb + d.extra * exp(-(v / d.stribeck_velocity) * (v / d.stribeck_velocity));
}

// R(v) [W]
static inline real joint_friction_power(const JointEffectLaw d, const real v) {
  const real y = fabs(v), eps = d.velocity;
  if (y < eps) return joint_sliding_friction(d, eps) * (smooth_coulomb(y, eps) - eps / 3);
  const real u = d.stribeck_velocity;
  const real extra = d.extra > 0 ? d.extra * 0.5 * sqrt(M_PI) * u * (erf(y / u) - erf(eps / u)) : 0;
  return joint_sliding_friction(d, eps) * 2 * eps / 3 + d.coulomb * (y - eps) + extra;
}

// R'(v) / v [N m s/rad or N s/m]
static inline real joint_friction_over_rate(const JointEffectLaw d, const real v) {
  const real y = fabs(v);
  return joint_sliding_friction(d, fmax(y, d.velocity)) * smooth_coulomb_slope_over(y, d.velocity);
}

// R''(v), never below zero [N m s/rad or N s/m]
static inline real joint_friction_curvature(const JointEffectLaw d, const real v) {
  const real y = fabs(v), eps = d.velocity;
  return y < eps ? joint_sliding_friction(d, eps) * 2 * (1 - y / eps) / eps : 0;
}

static inline real joint_effect_energy(const JointEffectLaw d, const real q, const real q0, const real h) {
  const real v = (q - q0) / h;
  return q * (0.5 * d.stiffness * q - d.preload) + h * (0.5 * d.damping * v * v + joint_friction_power(d, v));
}

static inline real joint_effect_slope(const JointEffectLaw d, const real q, const real q0, const real h) {
  const real v = (q - q0) / h;
  return d.stiffness * q - d.preload + (d.damping + joint_friction_over_rate(d, v)) * v;
}

static inline real joint_effect_curvature(const JointEffectLaw d, const real q, const real q0, const real h) {
  const real v = (q - q0) / h;
  return d.stiffness + (d.damping + joint_friction_curvature(d, v)) / h;
}

#endif
