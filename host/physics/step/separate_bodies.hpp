// Moves free bodies apart that intersect at the start: bounded, in a fixed order, the shorter way first. What is still
// in conflict afterwards is refused as ever, so nothing depends on this being clever.
#pragma once
#include <string>

#include "host/model/physical_scene.hpp"

namespace pvg {

struct Separation {
  std::string body;
  Vec3 by = Vec3::Zero();  // [m]
};

// Changes the poses in `scene`. A body is free that neither joints, stitches nor a prescribed motion hold; it moves up
// against gravity or sideways, as little as it takes to touch the other body no more, and half the activation distance
// on. Returns what was moved, in the order of bodies.
std::vector<Separation> separate_bodies(PhysicalScene& scene);

// One sentence, for people.
std::string describe(const Separation& moved);

}  // namespace pvg
