// How far the parameters move when a stretch of the recording is left out: what a model leaves and the fit takes up,
// such as a drag that is taken for less gravity, differs between stretches of a run although nothing scatters about the
// fit.
#pragma once
#include "host/identify/fit/fit.hpp"

namespace pvg::diagnose {

// Variances of the parameters by the jackknife over blocks (Kunsch 1989), to first order and with starts fitted again:
//   v = (K - 1) / K sum_b (x_b - mean)^2,   x_b: without block b, one of K stretches of the windows
// No block is shorter than the `correlated` samples that count as one. Zeros where that leaves too few blocks.
// a: the normal equations of the parameters, priors included
Eigen::VectorXd left_out_blocks(const Fit& fit, const std::vector<Window>& windows, const Eigen::MatrixXd& a,
                                double correlated);

}  // namespace pvg::diagnose
