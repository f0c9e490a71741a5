// How many samples of residuals count as one: those that hang together say less than as many independent ones.
#pragma once
#include <vector>

#include "host/identify/fit/fit.hpp"

namespace pvg::diagnose {

// 1 for white residuals, else the integrated autocorrelation of each window's channels, 1 + 2 sum_k rho_k up to the
// first lag at which rho_k is below the noise of its estimate. residual: [n_windows][n_data]
double correlation_length(const std::vector<Window>& windows, const std::vector<Eigen::VectorXd>& residual);

}  // namespace pvg::diagnose
