// The time step that the numbers of what was found need. Friction and play have kinks, of which a step is wrong to
// first order, and the step was chosen for a scene that perhaps had none: an error of half the noise, in step with the
// effect, may be many standard deviations of its numbers.
#pragma once
#include "host/identify/search/workflow.hpp"

namespace pvg::diagnose {

// Simulates what was found last with half the step. Where the residuals there ask for a number that is more than
// step_moved_most standard deviations away, it is fitted again. Where that moves one by more than its deviation, it is
// the base's step from then on and half of it is tried, up to step_n_polished times; the last move is added to the
// deviations. Steps that are part of the scene's model, as in hard impacts, stay as they are, and those of soft bodies
// and cloth, whose finer ones take too long.
void use_finer_steps(Workflow& flow, Selection& selected);

}  // namespace pvg::diagnose
