// The step and the integrator of the workflow's own simulations: the scene's, unless their error shows beside the
// noise.
#pragma once
#include <string>

#include "host/identify/fit/fit.hpp"

namespace pvg::diagnose {

// What the change from a step to its half is to be multiplied by to give the step's error, where halving once more
// changes the predictions by `ratio` less: of order log2(ratio), between the first and that of `most` (Richardson 1911).
double measured_richardson_factor(double ratio, double most);

// Sets the solver of `base` and says what it did. An error of the integration that the sensors can see would be taken
// for an effect (implicit Euler damps), so predictions are compared with those of finer steps and of second order. An
// error of a few times the noise is allowed: Fitter::prepare corrects it.
std::string choose_time_step(Fitter& fitter, Predictor& predictor, const Problem& problem, Variant& base);

}  // namespace pvg::diagnose
