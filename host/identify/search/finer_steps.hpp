// The time step that the numbers of what was found need. Friction and play have kinks, of which a step is wrong to
// first order, and the step was chosen for a scene that perhaps had none: an error of half the noise, in step with the
// effect, may be many standard deviations of its numbers.
#pragma once
#include "host/identify/search/workflow.hpp"

namespace pvg::diagnose {

// Fits what was found last again with half the step. Where a number moves by more than its standard deviation, that
// step is the base's from then on and half of it is tried, up to step_n_polished times; the last move is added to the
// deviations. Scenes with soft bodies or cloth, whose finer steps take too long, stay as they are.
void use_finer_steps(Workflow& flow, const ChosenWindows& chosen, Selection& selected);

}  // namespace pvg::diagnose
