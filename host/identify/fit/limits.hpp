// Parameters that are limits, such as a yield strain: a limit that the runs do not reach changes nothing, so no small
// change of it can be seen. Its "off" is set just above the value that changes the residuals first.
#pragma once
#include "host/identify/fit/fit.hpp"

namespace pvg::diagnose {

// Finds that place for each limit among the candidates by simulating the windows with lower and lower limits. A limit
// that never changes the residuals is left as it is.
void place_limits(Fitter& fitter, const FitData& data, const Fit& base, std::vector<Candidate>& candidates);

}  // namespace pvg::diagnose
