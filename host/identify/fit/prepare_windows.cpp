// Windows made ready for fits: sensitivities to their starts, and the error of their time step.
#include <algorithm>
#include <cmath>

#include "host/identify/criteria.hpp"
#include "host/identify/fit/fit.hpp"
#include "host/identify/sensing/step_order.hpp"

namespace pvg::diagnose {
namespace {

using Eigen::MatrixXd, Eigen::VectorXd;

}  // namespace

VectorXd beside_starts(const MatrixXd& u, const VectorXd& change) {
  if (u.cols() == 0) return change;
  const MatrixXd a = u.transpose() * u + MatrixXd::Identity(u.cols(), u.cols());
  return change - u * a.ldlt().solve(u.transpose() * change);
}

Variant refined(const Variant& variant) {
  Variant fine = variant;
  fine.scene.solver.time_step /= 2;
  return fine;
}

FitData Fitter::prepare(std::vector<Window> windows, const Model& at, bool corrects) {
  corrects = corrects && corrects_steps_;
  predictor_.settle(base_, windows);
  for (Window& window : windows) window.correction.resize(0);
  FitData data{std::move(windows), {}, at};
  const Variant variant = variant_of(base_, at);
  std::vector<Job> jobs;
  for (const Window& window : data.windows) {
    jobs.push_back({&variant, &window, window.initial, false});
    for (const Unknown& unknown : window.unknowns) {
      jobs.push_back(jobs.back());
      jobs.back().initial = window.initial;
      move(jobs.back().initial, unknown, criteria().difference_start * unknown.sigma);
    }
  }
  const std::vector<Prediction> found = predictor_.predict(jobs);
  const Variant fine = refined(variant);
  std::vector<Job> fine_jobs;
  if (corrects)
    for (const Window& window : data.windows) fine_jobs.push_back({&fine, &window, window.initial, false});
  const std::vector<Prediction> finer = predictor_.predict(fine_jobs);
  std::vector<Window> kept;
  std::size_t at_job = 0, at_window = 0;
  for (const Window& window : data.windows) {
    const Prediction* better = corrects ? &finer[at_window++] : nullptr;
    const Prediction& here = found[at_job++];
    MatrixXd u(Eigen::Index(window.data.size()), Eigen::Index(window.unknowns.size()));
    bool succeeded = here.succeeded;
    for (std::size_t k = 0; k < window.unknowns.size(); ++k, ++at_job) {
      succeeded = succeeded && found[at_job].succeeded;
      u.col(Eigen::Index(k)) = (found[at_job].residual - here.residual) / criteria().difference_start;
    }
    if (!succeeded) continue;
    kept.push_back(window);
    if (better && better->succeeded) {
      const double factor = step_factor_.value_or(richardson_factor(order_of_steps(base_)));
      const VectorXd change = factor * (better->residual - here.residual), left = beside_starts(u, change);
      if (left.norm() < criteria().step_correction_most * std::sqrt(double(left.size()))) kept.back().correction = left;
    }
    data.of_start.push_back(std::move(u));
  }
  data.windows = std::move(kept);
  return data;
}

bool Fitter::are_good_enough(const Fit& starts) {
  return !starts.succeeded || rms(starts.residual) < criteria().start_good_enough;
}

std::vector<VectorXd> Fitter::start_shifts(const Fit& starts) {
  // a wrong model must not move the starts far from the measured ones
  const double most = are_good_enough(starts) ? 0 : criteria().start_shift_most / criteria().start_looseness;
  std::vector<VectorXd> shifts;
  for (const VectorXd& delta : starts.delta) shifts.push_back(delta.cwiseMax(-most).cwiseMin(most));
  return shifts;
}

std::vector<Window> Fitter::with_moved_starts(std::vector<Window> windows, const std::vector<VectorXd>& shifts) {
  for (std::size_t w = 0; w < windows.size(); ++w)
    for (std::size_t k = 0; k < windows[w].unknowns.size(); ++k) {
      const Unknown& unknown = windows[w].unknowns[k];
      move(windows[w].initial, unknown, shifts[w][Eigen::Index(k)] * unknown.sigma);
    }
  return windows;
}

FitData Fitter::prepared_nearer(FitData data, const Fit& fit) {
  if (are_good_enough(fit)) return data;
  return prepare(with_moved_starts(std::move(data.windows), start_shifts(fit)), data.at);
}

}  // namespace pvg::diagnose
