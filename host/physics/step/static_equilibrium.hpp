// Static equilibrium of one soft body under dead loads, some of its nodes held:
//   minimise  sum_e V Psi(F_e) - sum_i f_i . x_i      by Newton's method with a sparse direct solver.
// Tells how stiff a mesh is, without time, contact or mass; the simulator does not use it.
#pragma once
#include <vector>

#include "host/device/device.hpp"
#include "host/model/physical_scene.hpp"

namespace pvg {

struct StaticProblem {
  TetMesh mesh;  // rest shape, 4 or 10 nodes per element
  SolidMaterial material;
  std::vector<std::uint32_t> held;  // nodes that stay at rest
  std::vector<Vec3> force;          // on each node [n_points, N]
};

struct StaticResult {
  std::vector<Vec3> points;  // where the nodes come to rest [n_points, m]
  int newton = 0;            // iterations
  double correction = 0;     // largest coordinate of the last correction, which was not applied [m]
};

// `start`: a shape near the answer, or empty for the rest shape. Throws a Failure when no node's next correction falls
// below `tolerance` [m], or the body is not held.
StaticResult solve_static(Device& device, const StaticProblem& problem, const std::vector<Vec3>& start = {},
                          double tolerance = 1e-10);

}  // namespace pvg
