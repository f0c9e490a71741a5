// Starts of joints that no channel measures themselves, from measured places on the bodies they carry: a pendulum that
// a camera tracks by a marker at its end.
#pragma once
#include <vector>

#include "host/identify/data/problem.hpp"

namespace pvg::diagnose {

// A place on a rigid body at the start of a window, along one direction of the world.
struct MeasuredPlace {
  int rigid = -1;
  Vec3 point = Vec3::Zero();  // in the body's frame [m]
  Vec3 direction = Vec3::UnitX();
  double value = 0, value_sigma = 1;  // [m]
  double rate = 0, rate_sigma = 1;    // [m/s]
};

struct JointStart {
  int joint = -1;
  double position = 0, rate = 0;  // [rad or m], [rad/s or m/s]
  double position_sigma = 0, rate_sigma = 0;
};

// Whether a channel measures the place of a body's origin, or of a point of it.
bool is_place_of_body(const Channel& channel);
bool is_point_of_body(const Channel& channel);

// Joints with a coordinate, parents first, that no channel measures and that carry a body of which places are measured.
std::vector<int> joints_seen_by_places(const Problem& problem);

// Coordinates and rates of these joints that fit the places best, by Gauss-Newton from `start`, which holds all others.
// Only those of which the places say more than half; one standard deviation each.
std::vector<JointStart> joints_from_places(const Problem& problem, const Run& run, const InitialState& start,
                                           const std::vector<int>& joints, const std::vector<MeasuredPlace>& places);

}  // namespace pvg::diagnose
