// The force law that the barrier makes: pressure of a box on a floor by the gap between them, under growing weight.
//   kappa |b'(g)|,  b' = -(g - d)(2 ln(g / d) + (g - d) / g) / d  for 0 < g < d      [Pa]
// (kernels/energies/contact/barrier_law.cl), d the activation distance; times how often the elements count the touching
// area.
#include <cmath>

#include "pipeline/validation/cases.hpp"

namespace pvg {
namespace {

double law(double gap, const ContactSettings& contact) {
  const double d = contact.activation_distance, x = gap - d;
  return contact.stiffness * x * (2 * std::log(gap / d) + x / gap) / d;
}

}  // namespace

void validate_contact_law(Validation& v) {
  Curve of_law{"kappa |b'(g)|", {}, {}, true}, of_box{"box of 0.1 m on the floor", {}, {}};
  SceneRun run = v.load("weight");
  run.scene.soft_bodies.clear();
  const double g = run.scene.gravity.norm(), side = 0.1;
  const int box = rigid_index(run.scene, "box");
  double least = 0, most = 0;
  for (const double pressure : {1e1, 1e2, 1e3, 1e4, 1e5, 1e6}) {
    const double force = pressure * side * side;
    RigidBody& body = run.scene.rigid_bodies[box];
    body.inertia *= force / g / body.mass;
    body.mass = force / g;
    double gap = 0;
    v.run(run, [&](const WorldState& state, const StepReport&) {
      gap = state.rigid[box](2, 3) - side / 2;
      return true;
    });
    const double factor = pressure / law(gap, run.scene.contact);
    least = least == 0 ? factor : std::min(least, factor);
    most = std::max(most, factor);
    of_box.x.push_back(1e3 * (run.scene.contact.activation_distance - gap));
    of_box.y.push_back(pressure);
  }
  for (double share = 3e-4; share < 0.98; share *= 1.2) {
    const double gap = (1 - share) * run.scene.contact.activation_distance;
    of_law.x.push_back(1e3 * (run.scene.contact.activation_distance - gap));
    of_law.y.push_back(law(gap, run.scene.contact));
  }
  v.report("pressure over kappa |b'(g)|, 10 Pa to 1 MPa: least", "1", 1, least, "barrier_law.cl");
  v.report("pressure over kappa |b'(g)|, 10 Pa to 1 MPa: most", "1", 1, most, "barrier_law.cl");
  Plot plot{"contact_law",
            "Contact pressure at the default contact settings",
            "activation distance minus gap [mm]",
            "pressure [Pa]",
            {of_law, of_box}};
  plot.x_is_logarithmic = plot.y_is_logarithmic = true;
  v.plot(std::move(plot));
}

}  // namespace pvg
