// The whole simulated state as arrays, named as in states.h5.
#pragma once
#include "pipeline/serve/protocol.hpp"
#include "pipeline/serve/served_task.hpp"

namespace pvg {

//   q, a, torque [J]   T_link [L, 3, 4]   T_rigid [R, 3, 4]   X_gripper/<name>, X_deform/<name> [V, 3]   reading [D]
//   contact/points, contact/normal, contact/friction_force [C, 3]   contact/gap, contact/normal_force [C]
//   contact/bodies [C, 2]
// and in the head "time", "links", "rigids", "bodies": names
void add_state_arrays(const ServedTask& task, Message& message);

}  // namespace pvg
