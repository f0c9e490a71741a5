// How a finger of a gripper gives way under a pressure on its pad, at the mesh of the task and at finer ones.
#pragma once
#include "host/device/device.hpp"
#include "host/geometry/tet_mesh.hpp"
#include "host/model/task.hpp"

namespace pvg {

// The finger's mesh as tasks use it, with four nodes per element; make_quadratic of it is the task's.
TetMesh linear_finger_mesh(const FingerSection& finger);

// Displacement of the pad along y [m] under each force [N], ascending, the foot held: the mean over the load, which is
// a pressure on the pad (y = 0) across its whole width, a bell of 6 mm about two thirds of the finger's height.
std::vector<double> pad_deflections(Device& device, const TetMesh& mesh, const SolidMaterial& material,
                                    const std::vector<double>& forces);

}  // namespace pvg
