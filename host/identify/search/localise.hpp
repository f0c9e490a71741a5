// Stage 3: where and when simulation and measurement part. Each body in each phase of its motion is a cell; a cell's
// residuals are tested against noise (chi-squared, false discoveries held by Benjamini and Hochberg 1995), and it has a
// share of all that noise does not explain.
#pragma once
#include <string>
#include <vector>

#include "host/identify/fit/fit.hpp"

namespace pvg::diagnose {

struct Cell {
  std::string body, phase;
  double share = 0;  // of the sum of squares beyond noise
  double rms = 0;    // [noise]
  double p_value = 1;
  bool is_significant = false;
  double onset = -1;  // of the first significant stretch in any run [s]; negative: none
  std::size_t n = 0;  // numbers compared
};

// phases: of each window's data, as Prediction says. Largest share first.
std::vector<Cell> localise(const Problem& problem, const std::vector<Window>& windows,
                           const std::vector<Eigen::VectorXd>& residual, const std::vector<std::vector<Phase>>& phases);

// Probability that noise alone makes a sum of squares of n residuals at least as large (Wilson and Hilferty 1931).
double chi_squared_tail(double sum, double n);

// Those first that act where most of the misfit is: on a body, or on one of the two that a joint or a contact holds
// together, by the sum of the cells' shares there. Errors of a channel are at the body that it measures. What acts on
// the whole scene or recording comes last; equals stay as they were. Numbers of the scene, effects and errors of the
// measurement take turns in this order: where the time ends a screening, each has had its share of it, and a number
// whose place holds little of the misfit is not behind every effect of the place that holds most.
void order_by_place(const Problem& problem, const std::vector<Cell>& where, std::vector<Candidate>& candidates);

}  // namespace pvg::diagnose
