// Whether what was fitted in the first round follows the recorded motion. Short windows have starts of their own, which
// take up much of what an effect changes: what explains all of them need not explain the runs.
#pragma once
#include "host/identify/fit/choose_windows.hpp"
#include "host/identify/search/round.hpp"

namespace pvg::diagnose {

// Whether the scene with any single effect is so near to the recorded motion that changes of it can be linearised: a
// drive that is far too stiff is found, the command of another run is not. In whole runs and long windows, which a
// swing may leave out of phase though little is missing, far_misfit_least decides, too. Else no pair and no law can be
// found, and a note says so. In the shortest windows, which a true effect explains nearly to the noise even where
// another one is missing beside it, one that leaves more has to be near to whole runs, where these can be judged.
bool any_follows(Workflow& flow, const ChosenWindows& windows, const Round& round);

// Where the effect that was chosen in windows does not follow whole runs, and another one does that explains nearly as
// much of the windows, those that do not are out.
void prefer_what_follows_whole_runs(Workflow& flow, const ChosenWindows& windows, Round& round);

// Whether even the best single effect leaves nearly all of a large misfit, as beside the command of another run; a note
// says so. Pairs may still explain it.
bool explains_little(Workflow& flow, const ChosenWindows& windows, const Fit& best);

}  // namespace pvg::diagnose
