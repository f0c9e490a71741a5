// The state of a body that flies free, from poses that were measured on the way.
//   x(t) = x0 + v t + g t^2 / 2,     R(t) = exp(w t) R0
// w is constant where the moments of inertia are equal, as a cube's.
#pragma once
#include <span>

#include "host/model/scene.hpp"

namespace pvg {

// At the first frame, world: [m], [m/s], [rad/s].
struct FlightStart {
  Pose pose = Pose::Identity();
  Vec3 velocity = Vec3::Zero(), angular_velocity = Vec3::Zero();
};

// Fits poses [n_frames, m] of which those from `first` to `end` - 1, at least two, were measured in flight. frame [s]
// lies between two of them, gravity [m/s^2]. Between neighbouring frames the body turns by less than half a turn.
// Throws UsageError where there are fewer than two.
FlightStart fit_flight(std::span<const Pose> poses, double frame, std::size_t first, std::size_t end,
                       const Vec3& gravity);

}  // namespace pvg
