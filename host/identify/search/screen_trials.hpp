// Changes of candidates that a screening tries: of which parameter, by how much, and what they do to the residuals.
#pragma once
#include <vector>

#include "host/identify/search/screen.hpp"

namespace pvg::diagnose {

// The base model with a candidate as it is tried first.
Model with_candidate(const Model& base, const Candidate& candidate);

// What the trials change in the residuals of each window; NaN where a simulation failed.
std::vector<std::vector<Eigen::VectorXd>> responses(Fitter& fitter, const FitData& data, const Fit& base,
                                                    const std::vector<Trial>& trials);
// Root of the mean square of one of them; negative: it failed.
double size_of(const std::vector<Eigen::VectorXd>& response);

// At most so many windows, evenly spread, and the base's fit of them.
FitData some_windows(const FitData& data, std::size_t most, Fit& base);

// A change of each parameter that changes the residuals by `wanted` times the noise; steps of 0: no sensor sees it.
// known: if wanted, the responses in all windows of those trials whose first change came within `response_off_most` of
// that, or the second one within its square, which are left at it; empty for the others.
std::vector<Trial> choose_steps(Fitter& fitter, const FitData& data, const Fit& base, double wanted,
                                const std::vector<const Candidate*>& candidates, double response_off_most = 1,
                                std::vector<std::vector<Eigen::VectorXd>>* known = nullptr);

// The same changes in the other direction, of numbers of the scene: a frequency that rises by a quarter of a turn does
// not predict the change of one that falls.
std::vector<Trial> mirrored(const std::vector<Trial>& trials);

// No slope predicts how far to go: all places of a grid are tried.
bool is_tried_anyway(const Candidate& candidate);

// Where a candidate is tried: shares of its linear optimum. Where the law is off, residuals are not sensitive to its
// shape parameter, so neither its optimum nor that of strengths beside the first is known: other shapes are tried, near
// ones with the strengths unchanged, all of them with equal strengths. n_base: parameters of the base.
std::vector<Model> places_of(const Screened& screened, Eigen::Index n_base);

// Where a law of several strengths and a shape is tried, such as friction that falls with speed. Which strengths fit
// depends on the shape, and a fit that begins at another shape, or at strengths of another one, ends in another
// minimum. So the strengths x are fitted at each of several shapes s by one Gauss-Newton step
//   x_s = argmin over low <= x <= high of |r(x_0) + J_s (x - x_0)|^2
// from x_0, where the first strength explains most alone, since the shape does nothing while the other ones are off.
// The models at the fitted strengths; none of another law. some: the windows in which it is tried, few: the base there,
// of which the candidate is the last part in `screened`.
std::vector<Model> places_at_shapes(Fitter& fitter, const FitData& some, const Fit& few, const Screened& screened);

}  // namespace pvg::diagnose
