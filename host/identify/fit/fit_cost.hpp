// The objective of a fit in its parts, and what follows from its normal equations (formula: fit.hpp).
#pragma once
#include "host/identify/fit/fit.hpp"

namespace pvg::diagnose {

double start_cost(const std::vector<Eigen::VectorXd>& delta);
double prior_cost(const Model& model);
double scale_of(const Fit& fit, std::size_t window);  // s of its residuals
double cost_of(const Fit& fit);                       // C

// Of the parameters [p x p]: what noise of the size of the residuals gives, `correlated` samples counting as one; on
// its diagonal at least the sandwich, its scores gathered by window and, where there are three or more, by run; with
// fewer runs, and residuals that hang together in time, at least what leaving out stretches of them moves. So an
// interval widens by what the model leaves, whether that hangs together in time or differs between runs. The error of
// the correction for the time step is added: how far the residuals say that it is too large or too small, and how well
// they tell.
Eigen::MatrixXd covariance_of(const Fit& fit, const std::vector<Window>& windows, double correlated);

// How far the correction for the time step moves the parameters [p], to first order, in the deviations that noise of
// the size of the residuals gives them; 0 where nothing is corrected.
Eigen::VectorXd moved_by_correction(const Fit& fit, const std::vector<Window>& windows);

}  // namespace pvg::diagnose
