// Named effects (host/model/effect.hpp) in the simulator. Those that change bodies, gravity or drives make another
// scene; the others are elements of energy terms:
//   joints: revolute_effect, prismatic_effect, of a formula revolute_law, prismatic_law (added with the joint)
//   bodies: point_force, spin; force_law writes the force of point_force before each step
//   solids: strain_effect_4 and _10, hyperelastic_4 and _10; plastic_flow changes their rest shape after each step
//   contact: adhesion in the barrier, dissipation in friction, slip_effects on its coefficient; rolling: spin
#pragma once
#include "host/physics/energies/system.hpp"

namespace pvg {

// The scene as it is with its effects. Throws a UsageError where an effect does not fit the scene.
PhysicalScene with_effects(const PhysicalScene& scene);

// Elements of one world's effects on bodies.
void add_body_effects(System& system, std::size_t world);
// The same on contacts; after the world's collision bodies.
void add_contact_effects(System& system, std::size_t world);

}  // namespace pvg
