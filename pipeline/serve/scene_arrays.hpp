// What a served scene answers with: where everything is and how fast it moves, what touches, which forces act.
#pragma once
#include "pipeline/serve/protocol.hpp"
#include "pipeline/serve/served_scene.hpp"

namespace pvg {

// T_rigid, V_rigid, joint/position, q, a, torque, reading; of soft bodies, then cloths X_gripper/NAME or X_deform/NAME
// of all, then V_gripper/NAME or V_deform/NAME of all, each one after the other
void add_scene_state(const ServedScene& served, Message& message);

// contact/..., pair_force/... of the last step
void add_scene_contacts(const ServedScene& served, Message& message);

// force/net, force/torque, joint/drive, stop, damping of the last step; joint/load_force, load_torque
void add_scene_forces(const ServedScene& served, Message& message);

}  // namespace pvg
