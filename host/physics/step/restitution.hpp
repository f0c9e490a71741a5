// Rebound of rigid bodies at a stated coefficient of restitution. A step of implicit integration takes an unknown share
// of an impact's energy, since the barrier acts over less than a step's way. So the step decides where bodies come to,
// and where a pair has a coefficient, this decides how fast they part (Newton's law of impact, as in Moreau's
// time-stepping):
//   n . v' = -e n . v      at every contact that met at the speed v, faster than gravity makes a body in two steps
//   n . v' <= max(n . v, 0)  at every other: what the barrier stores does not throw bodies apart
// by impulses along n no smaller than what takes back the contact's own push, and Coulomb friction of what is added.
// The kinetic energy never exceeds that of the step's start, with what gravity did.
#pragma once
#include <optional>
#include <span>
#include <vector>

#include "host/model/physical_scene.hpp"
#include "host/model/world_state.hpp"

namespace pvg {

// A pair of rigid bodies with a coefficient.
struct RestitutionPair {
  int first = -1, second = -1;
  double coefficient = 0, friction = 0;
};

// The pairs of a scene; throws a UsageError that names a pair which cannot have a coefficient: of an unknown or soft
// body, two that never move, one that a joint holds.
std::vector<RestitutionPair> restitution_pairs(const PhysicalScene& scene);

// Motion of a rigid body.  [m/s], [rad/s]
struct Twist {
  Vec3 velocity = Vec3::Zero();  // of the centre of mass
  Vec3 spin = Vec3::Zero();
};

// A rigid body at the end of a step.
struct MovingBody {
  Vec3 center = Vec3::Zero();       // of mass, world [m]
  double mass = 0;                  // [kg]; 0: nothing moves it
  Mat3 inertia = Mat3::Identity();  // world axes [kg m^2]
  Twist before, after;              // at the start of the step, and as it came out of it
  Vec3 path = Vec3::Zero();         // of the centre over the step [m]
};

// A contact at the end of a step, of two of these bodies.
struct Meeting {
  int first = -1, second = -1;
  Vec3 point = Vec3::Zero(), normal = Vec3::Zero();  // normal: from the second to the first
  double impulse = 0;                                // that the step gave along the normal [N s]
  double coefficient = 0, friction = 0;
};

// What the motions become, [n_bodies]; nothing where no contact asks for a change. h [s]
std::optional<std::vector<Twist>> restituted(std::span<const MovingBody> bodies, std::span<const Meeting> meetings,
                                             const Vec3& gravity, double h);

}  // namespace pvg
