#include "host/identify/search/prepared.hpp"

#include "host/identify/criteria.hpp"
#include "host/identify/search/choose_windows.hpp"

namespace pvg::diagnose {

const Fit& Prepared::base(Fitter& fitter) {
  if (!base_) base_ = fit_as_it_stands(fitter, data_);
  return *base_;
}

Fit prepared_again(Fitter& fitter, Prepared& prepared, const Fit& fit) {
  FitData near = fitter.prepare_near(prepared.data().windows, fit.model);
  if (near.windows.size() != prepared.data().windows.size()) return fit;
  std::vector<Fit> fits = fitter.begin(near, {fit.model});
  const double before = robust_cost(fits.front().residual, fit.scale);
  fitter.improve(near, fits, criteria().n_more_steps);
  fitter.finish(near, fits);
  if (!fits.front().succeeded || !(robust_cost(fits.front().residual, fit.scale) <= before)) return fit;
  prepared = Prepared(std::move(near));
  return fits.front();
}

}  // namespace pvg::diagnose
