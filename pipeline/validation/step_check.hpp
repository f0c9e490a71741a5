// What every step of every case must keep: no two surfaces intersect, every tetrahedron is upright, Newton's method
// converged. Judged from the states alone, by tests that the solver does not use.
#pragma once
#include <string>

#include "host/physics/energies/system.hpp"
#include "host/physics/step/simulation.hpp"

namespace pvg {

// Counts over all steps seen; what is wrong first is named.
struct StepCounts {
  bool has_contact = false, has_solids = false;  // what the scenes could do wrong at all
  int steps = 0, intersecting = 0, unconverged = 0;
  int inverted = 0;  // tetrahedra, summed over the steps
  std::string first_fault;
};

// Looks at the steps of one world. `Validation::run` does so by itself; a case that runs a Simulation of its own
// makes one of these per world.
class StepCheck {
 public:
  explicit StepCheck(const PhysicalScene& scene);
  void look(const WorldState& state, const StepReport& report, StepCounts& counts) const;

 private:
  System system_;
  bool can_touch_ = false;  // a pair of bodies that may, or one with itself
};

// Whether the element's map keeps its handedness: its corners, and where it has 10 nodes also the quadrature points of
// its energy. x: [n_points, m]
bool is_upright(const TetMesh& mesh, std::size_t element, const std::vector<Vec3>& x);

}  // namespace pvg
