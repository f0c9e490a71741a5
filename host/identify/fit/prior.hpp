// What is known of a parameter before any data, as -log of its density at x, a = (x - off) / sigma:
//   stated, or a sensor's error     a^2 / 2
//   a habit of scenes               (nu + 1) / 2 log(1 + a^2 / nu)   (Student): mostly near, and now and then far off
//   nothing                         a^2 / 2 with the width of its bounds for sigma, so that a parameter to which
//                                   nothing is sensitive keeps its value
#pragma once
#include "host/identify/candidates/candidate.hpp"

namespace pvg::diagnose {

double prior_cost(const Parameter& p, double x);
double prior_weight(const Parameter& p, double x);  // w: the gradient of the cost is w (x - off)

}  // namespace pvg::diagnose
