// What a fit minimises, taken apart, and what its normal equations tell (the formula stands in fit.hpp).
#pragma once
#include "host/identify/fit/fit.hpp"

namespace pvg::diagnose {

double start_cost(const std::vector<Eigen::VectorXd>& delta);
// One standard deviation of what is believed of a parameter, at most its bounds: what nothing in the data answers to
// stays where it is.
double believed_of(const Parameter& p);
double belief_cost(const Model& model);
double scale_of(const Fit& fit, std::size_t window);  // s of its residuals
double cost_of(const Fit& fit);                       // C

// Of the parameters: the sandwich, scores gathered by window, so that residuals that hang together within a window do
// not count as many; at least what independent noise gives.  [p x p]
Eigen::MatrixXd covariance_of(const Fit& fit);

}  // namespace pvg::diagnose
