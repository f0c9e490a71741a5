// Stage 6: which of the fitted models is named. Errors are those of windows that the fit has not seen: each group of
// windows (a run, where there are enough) is left out in turn, and the fit without it follows from the linear system at
// the optimum. Named is the simplest model within one standard error of the best, if it closes the gap by more than two
// standard errors and its parameters' interval does not hold "off".
#pragma once
#include <string>
#include <vector>

#include "host/identify/fit/fit.hpp"

namespace pvg::diagnose {

struct Judged {
  const Fit* fit = nullptr;
  double error = 0;         // left-out: root of the mean square of residuals cut at 4 scales [noise]
  double better_by = 0;     // mean square of the base's left-out error less this one's
  double better_sigma = 0;  // its standard error by noise alone
  double evidence = 0;      // log, relative: -C/s^2 - p/2 log n + prior
  double probability = 0;
  bool excludes_off = false;
  bool passes = false;
};

struct Decision {
  std::vector<Judged> ranking;           // best first
  int chosen = -1;                       // of ranking; -1: none passes
  std::vector<std::size_t> inseparable;  // of ranking, the chosen one among them; empty: nothing is as good
  // Of ranking, where one is more probable than the chosen one, has no more numbers, fits as well, and passes nothing
  // because a number of it ended at its bound: the chosen one then stands for what lies beyond that bound. -1: none.
  int better_at_bound = -1;
  double base_error = 0;
};

// base: the fit of what was there before.
Decision decide(const FitData& data, const Fit& base, const std::vector<Fit>& fits);

// A parameter that ended at a bound other than "off" was not measured: such a model passes nothing. Nuisances may:
// their bounds are as far as their priors reach.
bool is_at_bound(const Fit& fit);

// The lowest training error, without a test.
Decision decide_lowest(const Fit& base, const std::vector<Fit>& fits);

}  // namespace pvg::diagnose
