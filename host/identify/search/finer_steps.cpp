#include "host/identify/search/finer_steps.hpp"

#include <fmt/format.h>

#include "host/identify/criteria.hpp"

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

// Whether the numbers that were found changed by more than their standard deviations.
bool moved(const Fit& before, const Fit& after) {
  const Eigen::VectorXd by = (after.model.x - before.model.x).cwiseAbs();
  return (by.array() > after.covariance.diagonal().cwiseMax(0).cwiseSqrt().array()).any();
}

}  // namespace

void use_finer_steps(Workflow& flow, const ChosenWindows& chosen, Selection& selected) {
  const PhysicalScene& scene = flow.base.scene;
  if (selected.fits.empty() || !scene.soft_bodies.empty() || !scene.cloths.empty()) return;
  Fit& found = selected.fits.back();
  double& step = flow.base.scene.solver.time_step;
  flow.ends_in_time(criteria().time_proof, "the numbers of what was found with finer time steps", [&] {
    for (int n = 0; n < criteria().step_n_polished; ++n) {
      TriedStep tried(step, step / 2);
      const std::vector<Window> windows = selected.is_of_whole_runs
                                              ? make_windows(flow.problem, false, 0, chosen.data.windows.size())
                                              : chosen.data.windows;
      const FitData data = flow.fitter.prepare(windows, found.model);
      if (data.windows.size() != windows.size()) return;
      const Fit fit = flow.fitter.fit(data, {found.model}, criteria().n_more_steps).front();
      if (!fit.succeeded) return;
      const Eigen::VectorXd by = fit.model.x - found.model.x;
      const Eigen::MatrixXd covariance = fit.covariance + by * by.transpose();
      const bool needs_it = moved(found, fit);
      if (needs_it) {
        flow.notes.push_back(
            fmt::format("numbers of what was found moved by up to {:.2g} standard deviations with steps of "
                        "{:.4g} ms, which are used from here on",
                        (by.array() / fit.covariance.diagonal().array().sqrt()).abs().maxCoeff(), 1e3 * step));
        found.model = fit.model;
        tried.keep();
        selected.is_of_other_steps = true;
      }
      found.covariance = covariance;
      if (!needs_it) return;
    }
  });
}

}  // namespace pvg::diagnose
