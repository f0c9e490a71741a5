#include "host/identify/search/finer_steps.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "host/identify/criteria.hpp"
#include "host/identify/fit/fit_cost.hpp"

namespace pvg::diagnose {
namespace {

// The step of the base while this lives, unless it is kept.
class TriedStep {
 public:
  TriedStep(double& step, double tried) : step_(step), before_(step) { step = tried; }
  ~TriedStep() {
    if (!is_kept_) step_ = before_;
  }
  TriedStep(const TriedStep&) = delete;
  TriedStep& operator=(const TriedStep&) = delete;
  void keep() { is_kept_ = true; }

 private:
  double& step_;
  double before_;
  bool is_kept_ = false;
};

// The largest of these changes of the parameters, in standard deviations of the fit.
double in_deviations(const Eigen::VectorXd& by, const Fit& fit) {
  double most = 0;
  for (Eigen::Index i = 0; i < by.size(); ++i)
    if (fit.covariance(i, i) > 0) most = std::max(most, std::abs(by[i]) / std::sqrt(fit.covariance(i, i)));
  return most;
}

// The largest change of a number, in deviations, that these residuals instead of the fit's ask for, to first order.
double asked_for(const Fit& fit, std::vector<Window> windows, const std::vector<Eigen::VectorXd>& residual) {
  for (std::size_t w = 0; w < windows.size(); ++w) windows[w].correction = residual[w] - fit.residual[w];
  return moved_by_correction(fit, windows).cwiseAbs().maxCoeff();
}

}  // namespace

void use_finer_steps(Workflow& flow, Selection& selected) {
  const PhysicalScene& scene = flow.base.scene;
  if (selected.fits.empty() || !scene.soft_bodies.empty() || !scene.cloths.empty()) return;
  Fit& found = selected.fits.back();
  if (!flow.fitter.corrects_steps()) return;
  double& step = flow.base.scene.solver.time_step;
  flow.ends_in_time(criteria().time_proof, "the numbers of what was found with finer time steps", [&] {
    for (int n = 0; n < criteria().step_n_polished; ++n) {
      TriedStep tried(step, step / 2);
      const FitData data = flow.fitter.prepare(selected.windows, found.model);
      if (data.windows.size() != found.delta.size()) return;
      std::vector<Fit> fits = flow.fitter.begin(data, {found.model}, found.delta);
      if (!fits.front().succeeded) return;
      if (asked_for(found, data.windows, fits.front().residual) < criteria().step_moved_most) return;
      flow.fitter.improve(data, fits, criteria().n_more_steps);
      flow.fitter.finish(data, fits);
      Fit& fit = fits.front();
      if (!fit.succeeded) return;
      const Eigen::VectorXd by = fit.model.x - found.model.x;
      const double most = in_deviations(by, fit);
      fit.covariance += by * by.transpose();
      if (most <= 1) {
        found.covariance = std::move(fit.covariance);
        return;
      }
      flow.notes.push_back(
          fmt::format("numbers of what was found moved by {:.2g} standard deviations with steps of {:.4g} ms, "
                      "which are used from here on",
                      most, 1e3 * step));
      found = std::move(fit);
      tried.keep();
    }
  });
}

}  // namespace pvg::diagnose
