// The functions of the validation cases, by theme.
#pragma once
#include "pipeline/validation/validation.hpp"

namespace pvg {

// 0.5 as "0.5", 10 as "10.0"
std::string short_number(double value);  // elasticity.cpp

// The scene's first soft body as a bar in other cells; stitched is what lies in the box that the stitched nodes
// spanned.
void set_divisions(SceneRun& run, const Vec3& size, const std::array<int, 3>& divisions,
                   int nodes_per_element);  // elasticity.cpp

// friction.cpp
void validate_slope(Validation& v);
void validate_ramp(Validation& v);
void validate_stopping(Validation& v);
void validate_weight(Validation& v);
void validate_grasp(Validation& v);

// dynamics.cpp
void validate_free_fall(Validation& v);
void validate_oscillator(Validation& v);
void validate_pendulum(Validation& v);
void validate_spin(Validation& v);
void validate_momentum(Validation& v);

// elasticity.cpp
void validate_tensile(Validation& v);
void validate_rib(Validation& v);
void validate_elastica(Validation& v);
void validate_heavy_cantilever(Validation& v);

// cloth.cpp
void validate_heavy_cantilever_cloth(Validation& v);
void validate_drape(Validation& v);

// contact_law.cpp
void validate_contact_law(Validation& v);

// finger.cpp
void validate_finger(Validation& v);

// structures.cpp
void validate_stack(Validation& v);
void validate_arch(Validation& v);
void validate_card_house(Validation& v);

// contact.cpp
void validate_hertz(Validation& v);
void validate_squeeze_out(Validation& v);
void validate_knives(Validation& v);
void validate_slots(Validation& v);
void validate_twist(Validation& v);
void validate_touching(Validation& v);

// measured.cpp
void validate_cube_toss(Validation& v);
void validate_silicone_beam(Validation& v);

// joints.cpp
void validate_joint_signs(Validation& v);
void validate_drive(Validation& v);
void validate_four_bar(Validation& v);

}  // namespace pvg
