// The objective of a fit in its parts, and what follows from its normal equations (formula: fit.hpp).
#pragma once
#include "host/identify/fit/fit.hpp"

namespace pvg::diagnose {

double start_cost(const std::vector<Eigen::VectorXd>& delta);
// Standard deviation of a parameter's prior, by default the width of its bounds: a parameter to which nothing is
// sensitive keeps its value.
double prior_sigma_of(const Parameter& p);
double prior_cost(const Model& model);
double scale_of(const Fit& fit, std::size_t window);  // s of its residuals
double cost_of(const Fit& fit);                       // C

// Of the parameters: the sandwich, scores gathered by window, so that correlated residuals of a window do
// not count as many; at least what independent noise gives.  [p x p]
Eigen::MatrixXd covariance_of(const Fit& fit);

}  // namespace pvg::diagnose
