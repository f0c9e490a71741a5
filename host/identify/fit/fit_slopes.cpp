// Sensitivities of the residuals to parameters and to the starts of windows by finite differences: all in one batch of
// worlds.
#include <algorithm>
#include <cmath>

#include "host/identify/criteria.hpp"
#include "host/identify/fit/fit.hpp"

namespace pvg::diagnose {
namespace {

using Eigen::VectorXd;

Job job_of(const Variant& variant, const Window& window, const VectorXd& delta) {
  Job job{&variant, &window, window.initial, false};
  for (std::size_t k = 0; k < window.unknowns.size(); ++k)
    move(job.initial, window.unknowns[k], delta[Eigen::Index(k)] * window.unknowns[k].sigma);
  return job;
}

// share: of the parameter's distance from "off", or of its scale; of a logarithmic one of its value
double step_of(const Parameter& p, double x, double scale, double share) {
  const double by = share * (p.is_logarithmic ? x : std::max(std::abs(x - p.off), scale));
  return x + by > p.high ? -by : by;
}

}  // namespace

void Fitter::differentiate(const FitData& data, std::vector<Fit>& fits, Which which) {
  const std::size_t n_windows = data.windows.size();
  const auto is_open = [&](const Fit& fit) {
    return fit.succeeded && (which == Which::all || !(fit.has_converged || fit.is_given_up));
  };
  const auto wants_slope = [&](const Fit& fit) { return is_open(fit) && fit.is_stale && which != Which::open_starts; };
  const auto wants_start = [&](const Fit& fit, std::size_t w) {
    return is_open(fit) && fit.start_slope[w] == StartSlope::stale;
  };
  std::vector<Variant> variants;
  std::size_t n_variants = fits.size();
  for (const Fit& fit : fits) n_variants += std::size_t(fit.model.x.size());
  variants.reserve(n_variants);  // jobs point to them
  std::vector<Job> jobs;
  for (const Fit& fit : fits) {
    const std::vector<const Parameter*> parameters = fit.model.parameters();
    for (Eigen::Index i = 0; wants_slope(fit) && i < fit.model.x.size(); ++i) {
      Model moved = fit.model;
      moved.x[i] += step_of(*parameters[std::size_t(i)], fit.model.x[i], fit.model.scale[i], difference_);
      variants.push_back(variant_of(base_, moved));
      for (std::size_t w = 0; w < n_windows; ++w)
        jobs.push_back(job_of(variants.back(), data.windows[w], fit.delta[w]));
    }
    variants.push_back(variant_of(base_, fit.model));
    for (std::size_t w = 0; w < n_windows; ++w)
      for (Eigen::Index k = 0; wants_start(fit, w) && k < fit.delta[w].size(); ++k) {
        VectorXd moved = fit.delta[w];
        moved[k] += criteria().difference_start;
        jobs.push_back(job_of(variants.back(), data.windows[w], moved));
      }
  }
  const std::vector<Prediction> found = predictor_.predict(jobs);
  std::size_t at = 0;
  for (Fit& fit : fits) {
    if (wants_slope(fit)) {
      const std::vector<const Parameter*> parameters = fit.model.parameters();
      fit.slope.assign(n_windows, {});
      for (std::size_t w = 0; w < n_windows; ++w) fit.slope[w].setZero(fit.residual[w].size(), fit.model.x.size());
      for (Eigen::Index i = 0; i < fit.model.x.size(); ++i) {
        const double step = step_of(*parameters[std::size_t(i)], fit.model.x[i], fit.model.scale[i], difference_);
        std::vector<VectorXd> change;
        for (std::size_t w = 0; w < n_windows; ++w) change.push_back(found[at++].residual - fit.residual[w]);
        for (std::size_t w = 0; w < n_windows && !(rms(change) < criteria().unseen_change); ++w)
          if (change[w].allFinite()) fit.slope[w].col(i) = change[w] / step;
      }
      fit.is_stale = false;
    }
    for (std::size_t w = 0; w < n_windows; ++w) {
      if (!wants_start(fit, w)) continue;
      for (Eigen::Index k = 0; k < fit.delta[w].size(); ++k) {
        const Prediction& response = found[at++];
        if (response.succeeded)
          fit.of_start[w].col(k) = (response.residual - fit.residual[w]) / criteria().difference_start;
      }
      fit.start_slope[w] = StartSlope::here;
    }
  }
}

}  // namespace pvg::diagnose
