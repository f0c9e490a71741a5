// Parameters that are limits, such as a yield strain: beyond what the runs reach they do nothing at all, so no small
// change from there is ever seen. "Off" is put just above where the limit is first felt.
#pragma once
#include "host/identify/fit/fit.hpp"

namespace pvg::diagnose {

// Finds that place for each limit among the candidates by simulating the windows with lower and lower limits. A limit
// that is felt nowhere stays as it is.
void place_limits(Fitter& fitter, const FitData& data, const Fit& base, std::vector<Candidate>& candidates);

}  // namespace pvg::diagnose
