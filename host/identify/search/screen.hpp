// Stage 4: which candidates could explain the residual at all. Each one is switched on by a change that the sensors can
// see, as worlds of one solve; the change of the residuals is its signature, and the best sum of a candidate's
// signatures, with every window's start free, bounds how much of the misfit it explains.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "host/identify/fit/fit.hpp"

namespace pvg::diagnose {

struct Screened {
  const Candidate* candidate = nullptr;
  Model model;             // the base model with the candidate at its linear optimum
  double gain = 0;         // by which C would fall, less (number of parameters) / 2 log(number of data)
  double sensitivity = 0;  // rms change of the residuals by the change tried [noise]; 0: not visible in the data
};

// Sensitivities of residuals to candidates' parameters, starts free:  C(x) ~ C(0) + g x + x A x / 2, x in units of
// steps. Parameters without sensitivity are left out; those of one candidate are neighbours.
struct Signatures {
  std::vector<const Candidate*> candidate;  // [n]
  std::vector<std::size_t> parameter;       // [n] of the candidate
  std::vector<double> step;                 // [n] [unit]
  Eigen::MatrixXd a;                        // [n x n]
  Eigen::MatrixXd information;              // [n x n] a where the residuals are noise and nothing else
  Eigen::VectorXd g;                        // [n]
};
// base: without any effect; its nuisances are free
Signatures signatures_of(Fitter& fitter, const FitData& data, const Fit& base,
                         const std::vector<const Candidate*>& candidates);

// Where g x + x A x / 2 is least with each x between its bounds, which hold zero. What would go beyond a bound is set
// to it, the farthest first, and the others are found again beside it.
Eigen::VectorXd least_within(const Eigen::MatrixXd& a, const Eigen::VectorXd& g, const Eigen::VectorXd& low,
                             const Eigen::VectorXd& high);

// How much of its time a screening may take. Where a simulation takes long, candidates are screened some at a time, in
// their order, until a share of the time is over.
struct Effort {
  std::size_t at_once = SIZE_MAX;                   // candidates
  double share = 1;                                 // of the time until the deadline
  std::size_t n_tried = criteria().screen_n_tried;  // candidates that are simulated at their optimum
  std::size_t n_fitted = criteria().n_fitted;       // candidates that are fitted, at least
};

struct ScreeningResult {
  std::vector<Screened> best;  // best first
  std::size_t n_screened = 0;  // of the candidates, the first ones
};

// base: the fit of what is there already (perhaps nothing). Candidates that fail or do nothing are left out.
// signatures: what was found of them, if wanted, where the base is without any effect.
ScreeningResult screen(Fitter& fitter, const FitData& data, const Fit& base,
                       const std::vector<const Candidate*>& candidates, Signatures* signatures = nullptr,
                       const Effort& effort = {});

// Where C is least with these columns alone, and by how much it falls at x.
Eigen::VectorXd optimum_of(const Signatures& signatures, std::span<const std::size_t> columns);
double gain_at(const Signatures& signatures, std::span<const std::size_t> columns, const Eigen::VectorXd& x);

// The best ones to fit: `most` of them, yet always the best two of each family.
std::vector<Screened> shortlist(const std::vector<Screened>& screened, std::size_t most);

}  // namespace pvg::diagnose
