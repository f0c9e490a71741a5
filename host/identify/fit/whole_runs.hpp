// Held-out runs simulated whole from their first state: what a model must hold on wherever the start's error does not
// grow too much. Short windows prove too little, since each has a start of its own: a drive that is off predicts a
// quarter of a second well.
#pragma once
#include <string>
#include <vector>

#include "host/identify/fit/held_out.hpp"

namespace pvg::diagnose {

// At most so much of the beginning of each run [s], and nothing after a disturbance. The errors of WholeRuns are NaN
// where they could not be judged, and `why_not` says why.
WholeRuns judge_whole_runs(Fitter& fitter, const Problem& problem, double longest, const Model& named, bool in_noise,
                           const std::vector<Disturbance>& disturbed);

// By how much the measured error of a start has grown in the last quarter of a window [noise]: the largest root mean
// square over its unknowns. of_start: [n_data x n_unknowns] in units of the unknowns' sigma.
double start_growth(const Eigen::MatrixXd& of_start);

}  // namespace pvg::diagnose
