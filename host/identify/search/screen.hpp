// Stage 4: which candidates could explain the residual at all. Each one is switched on by a change that the sensors can
// see, as worlds of one solve; the change of the residuals is its signature, and the best sum of a candidate's
// signatures, with every window's start free, bounds how much of the misfit it explains.
#pragma once
#include <cstdint>
#include <vector>

#include "host/identify/fit/fit.hpp"

namespace pvg::diagnose {

// A change of one parameter that a screening simulates.
struct Trial {
  const Candidate* candidate;
  std::size_t parameter;
  double step;
};

// What such changes do to the residuals. Trials of one candidate are neighbours; those of numbers to the other side
// come after all others.
struct Changes {
  std::vector<Trial> trials;
  std::vector<std::vector<Eigen::VectorXd>> found;  // [n_trials][n_windows][n_data, noise]
  std::size_t n_first = 0;                          // trials to the one side
};

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
  std::size_t n_per_family = criteria().n_fitted_per_family, n_per_family_beside = n_per_family;  // beside an effect
  // A first change whose response is within this factor of what is wanted is not made again, nor a second one within
  // its square; 1: each is.
  double response_off_most = 1;
  bool tries_both_sides = true;                                                          // of numbers
  int n_first_steps = criteria().n_first_steps, n_more_steps = criteria().n_more_steps;  // of a round's fits
  std::size_t n_finalists = criteria().n_finalists;
};

struct ScreeningResult {
  std::vector<Screened> best;  // best first
  std::size_t n_screened = 0;  // of the candidates, the first ones
  Changes changes;             // of these
};

// base: the fit of what is there already (perhaps nothing). Candidates that fail or do nothing are left out.
// signatures: what was found of them, if wanted, where the base is without any effect.
ScreeningResult screen(Fitter& fitter, const FitData& data, const Fit& base,
                       const std::vector<const Candidate*>& candidates, Signatures* signatures = nullptr,
                       const Effort& effort = {});

// The same beside the effects of `fitted` by what the candidates change beside the scene as it stands, which is not
// simulated again: how one effect answers depends on another only to second order, and where it does, the fit tells.
// Candidates that were not screened are left out. fitted: with slopes; changes: in the windows of `data`.
std::vector<Screened> screen_by_changes(const FitData& data, const Fit& fitted,
                                        const std::vector<const Candidate*>& candidates, const Changes& changes);

// Whether changes were simulated in these windows.
bool are_in(const Changes& changes, const FitData& data);

// The best ones to fit: `most` of them, yet always the best n_per_family of each family.
std::vector<Screened> shortlist(const std::vector<Screened>& screened, std::size_t most,
                                std::size_t n_per_family = criteria().n_fitted_per_family);

}  // namespace pvg::diagnose
