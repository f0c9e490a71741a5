// What stands by friction alone.
#include <algorithm>

#include "pipeline/validation/cases.hpp"

namespace pvg {
namespace {

constexpr double SETTLED = 0.5;  // [s] what moves before is the landing

// Largest way that the origin of a moving body goes from the time `from` on [m]; ends early once it is beyond `enough`.
double drift(const Validation& v, const SceneRun& run, double from, double enough) {
  std::vector<AffineMap> start;
  double worst = 0;
  v.run(run, [&](const WorldState& state, const StepReport&) {
    if (state.time < from) return true;
    if (start.empty()) start = state.rigid;
    for (std::size_t b = 0; b < start.size(); ++b)
      worst = std::max(worst, (state.rigid[b].col(3) - start[b].col(3)).norm());
    return worst <= enough;
  });
  return worst;
}

}  // namespace

void validate_stack(Validation& v) {
  v.check_at_most("drift from 0.5 s to 5 s", "m", drift(v, v.load("stack"), SETTLED, 0.1), 1e-3, "stands");
}

void validate_card_house(Validation& v) {
  v.check_at_most("drift from 0.5 s to 5 s", "m", drift(v, v.load("card_house"), SETTLED, 0.1), 1e-3, "stands");
}

void validate_arch(Validation& v) {
  const auto with_friction = [&](double coefficient) {
    SceneRun run = v.load("arch");
    for (RigidBody& body : run.scene.rigid_bodies) body.friction = coefficient;
    return run;
  };
  v.check_at_most("mu 0.5: drift from 0.5 s to 2 s", "m", drift(v, with_friction(0.5), SETTLED, 0.1), 1e-3, "stands");
  v.check_true("mu 0.2: a block moves by more than 0.1 m", drift(v, with_friction(0.2), 0, 0.1) > 0.1, "falls");
}

}  // namespace pvg
