// Sums of the contacts' forces, by body and by pair of bodies. The small couple that the mollifier of nearly parallel
// edges adds to a pair is in no contact's force, hence not in the torques.
#pragma once
#include "host/model/physical_scene.hpp"
#include "host/model/world_state.hpp"

namespace pvg {

// Sets body_force and pair_force from the state's contacts.
void sum_forces(const PhysicalScene& scene, WorldState& state);

}  // namespace pvg
