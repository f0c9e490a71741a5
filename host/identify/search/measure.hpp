// Stages 1 and 2 of a diagnosis: how large the noise is and which time step does not show beside it; and what the scene
// as it stands leaves of the measurement.
#pragma once
#include <string>

#include "host/identify/search/workflow.hpp"

namespace pvg::diagnose {

// Stage 1: measures the noise of the problem's channels and chooses the time step of flow.base. Returns the unit of
// held-out errors: that of all channels, or "noise" where they have several.
std::string measure(Workflow& flow);

// Stage 2: windows that the model can follow, and what it leaves in them, with the numbers that have a prior free.
// deadline: a share of the time given. No window: there was no time.
ChosenWindows find_residual(Workflow& flow, double deadline);

}  // namespace pvg::diagnose
