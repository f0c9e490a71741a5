// Within the rate eps over which the dry friction T of a joint is smoothed its curvature is up to 2 T / (eps h), so
// large that a correction from there is F / (2 T) eps, whatever force F is left. That it is slow proves nothing before
// it is slow beside eps:
//   v_tol = min(velocity_tolerance, 0.1 eps r),   r = (a . I a / m + |a x c|^2)^1/2
// r: the child's radius of gyration about the axis a, I its inertia, c its centre of mass from the axis; 1 where it
// slides.
#include "host/physics/step/newton_tolerance.hpp"

#include <algorithm>
#include <cmath>

#include "host/model/effect_row.hpp"

namespace pvg {
namespace {

constexpr double SHARE_OF_SMOOTHING = 0.1;

double reach_of(const PhysicalScene& scene, const Joint& joint) {
  if (joint.type != Joint::Type::revolute) return 1;
  const RigidBody& child = scene.rigid_bodies.at(std::size_t(joint.child));
  const Vec3 axis = joint.child_frame.linear() * joint.axis;
  const Vec3 center = child.center_of_mass - joint.child_frame.translation();
  return child.mass > 0 ? std::sqrt(axis.dot(child.inertia * axis) / child.mass + axis.cross(center).squaredNorm()) : 1;
}

}  // namespace

double newton_tolerance(const PhysicalScene& scene) {
  double tolerance = scene.solver.velocity_tolerance;
  for (const Effect& effect : scene.effects) {
    JointNumbers numbers;
    if (!add_numbers(effect, numbers) || !(numbers.coulomb + numbers.extra > 0)) continue;
    for (const Joint& joint : scene.joints)
      if (joint.name == effect.target)
        tolerance = std::min(tolerance, SHARE_OF_SMOOTHING * numbers.velocity * reach_of(scene, joint));
  }
  return tolerance;
}

}  // namespace pvg
