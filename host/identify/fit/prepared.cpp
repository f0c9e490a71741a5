#include "host/identify/fit/prepared.hpp"

#include "host/identify/criteria.hpp"
#include "host/identify/fit/choose_windows.hpp"

namespace pvg::diagnose {

const Fit& Prepared::base(Fitter& fitter) {
  if (!base_) base_ = fit_as_it_stands(fitter, data_);
  return *base_;
}

Fit prepared_again(Fitter& fitter, Prepared& prepared, const Fit& fit, int n_steps) {
  const std::vector<Eigen::VectorXd> shifts = Fitter::start_shifts(fit);
  FitData near = fitter.prepare(Fitter::with_moved_starts(prepared.data().windows, shifts), fit.model);
  if (near.windows.size() != prepared.data().windows.size()) return fit;
  std::vector<Eigen::VectorXd> starts;  // the same states as before
  for (std::size_t w = 0; w < near.windows.size(); ++w) {
    if (near.windows[w].unknowns.size() != std::size_t(fit.delta[w].size())) return fit;
    starts.push_back(fit.delta[w] - shifts[w]);
  }
  std::vector<Fit> fits = fitter.begin(near, {fit.model}, std::move(starts));
  const double before = robust_cost(fits.front().residual, fit.scale);
  fitter.improve(near, fits, n_steps);
  fitter.finish(near, fits);
  if (!fits.front().succeeded || !(robust_cost(fits.front().residual, fit.scale) <= before)) return fit;
  prepared = Prepared(std::move(near));
  return fits.front();
}

}  // namespace pvg::diagnose
