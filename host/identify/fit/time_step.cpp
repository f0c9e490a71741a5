#include "host/identify/fit/time_step.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <optional>
#include <utility>

#include "host/base/statistics.hpp"
#include "host/identify/criteria.hpp"
#include "host/identify/fit/whole_runs.hpp"
#include "host/identify/sensing/step_order.hpp"

namespace pvg::diagnose {
namespace {

struct Choice {
  SolverSettings::Integrator integrator;
  double time_step;
};

// rms of the difference of two predictions of the same windows [noise]; the largest tenth of each column of a window is
// left out: an impact one step earlier is no error of the motion. Columns in which almost nothing happens are left out,
// too: they would only dilute the error of those that move.
double apart(const FitData& data, const std::vector<Prediction>& a, const std::vector<Prediction>& b,
             std::optional<std::size_t> only_window = {}) {
  std::map<std::pair<int, int>, std::pair<double, double>> columns;  // channel, component: sum of squares, how many
  for (std::size_t w = 0; w < a.size(); ++w) {
    if (only_window && w != *only_window) continue;
    if (!a[w].succeeded || !b[w].succeeded) continue;
    const Eigen::VectorXd d = beside_starts(data.of_start[w], a[w].residual - b[w].residual);
    std::map<std::pair<int, int>, std::vector<double>> squares;
    for (std::size_t i = 0; i < data.windows[w].data.size(); ++i) {
      const Datum& datum = data.windows[w].data[i];
      squares[{datum.channel, datum.component}].push_back(d[Eigen::Index(i)] * d[Eigen::Index(i)]);
    }
    for (auto& [column, values] : squares) {
      std::sort(values.begin(), values.end());
      const std::size_t kept =
          std::max<std::size_t>(1, std::size_t(criteria().step_kept_share * double(values.size())));
      columns[column].first += std::accumulate(values.begin(), values.begin() + std::ptrdiff_t(kept), 0.0);
      columns[column].second += double(kept);
    }
  }
  double most = 0, sum = 0, n = 0;
  for (const auto& [column, total] : columns) most = std::max(most, total.first / total.second);
  for (const auto& [column, total] : columns) {
    if (total.first / total.second < criteria().step_quiet_column * criteria().step_quiet_column * most) continue;
    sum += total.first;
    n += total.second;
  }
  return n > 0 ? std::sqrt(sum / n) : INFINITY;
}

// The same of the window where it is largest: a fast run among slow ones shows what the step costs it.
double most_apart(const FitData& data, const std::vector<Prediction>& a, const std::vector<Prediction>& b) {
  double most = apart(data, a, b);
  for (std::size_t w = 0; w < a.size(); ++w)
    if (const double here = apart(data, a, b, w); std::isfinite(here)) most = std::max(most, here);
  return most;
}

// rms of the difference in the window where it is largest, nothing left out [noise].
double largest_change(const FitData& data, const std::vector<Prediction>& a, const std::vector<Prediction>& b) {
  double largest = 0;
  for (std::size_t w = 0; w < a.size(); ++w)
    if (a[w].succeeded && b[w].succeeded)
      largest = std::max(largest, rms({beside_starts(data.of_start[w], a[w].residual - b[w].residual)}));
  return largest;
}

// The error of a step from its change by half of it [noise]: over all windows, and what is to be corrected in the run
// that needs it most. In short windows an impact is no motion to correct.
struct StepError {
  double all = 0, most = 0;
};

StepError error_of(const Problem& problem, const FitData& data, double factor, const std::vector<Prediction>& coarse,
                   const std::vector<Prediction>& fine) {
  const bool are_whole = std::all_of(data.windows.begin(), data.windows.end(), [&](const Window& window) {
    const Run& run = problem.runs[std::size_t(window.run)];
    return window.start == run.t.front() && window.end == run.t.back();
  });
  return {factor * apart(data, coarse, fine), are_whole ? factor * largest_change(data, coarse, fine) : 0};
}

bool is_below(const StepError& error, double allowed) {
  return error.all < allowed && error.most < criteria().step_correction_most;
}

// Median over the windows of the rms of the residuals with the best starts [noise].
double misfit(const FitData& data, const std::vector<Prediction>& predictions) {
  std::vector<double> of_window;
  for (std::size_t w = 0; w < predictions.size(); ++w)
    of_window.push_back(predictions[w].succeeded ? rms({beside_starts(data.of_start[w], predictions[w].residual)})
                                                 : INFINITY);
  if (of_window.empty()) return INFINITY;
  return upper_median(std::move(of_window));
}

// Where steps are compared: over whole runs, as these are fitted and proved, if the errors of their starts do not
// outgrow those of the steps, as in chaos and impacts; else in short windows. Of pictures too, which cost more than
// steps.
FitData where_steps_show(Fitter& fitter, const Problem& problem) {
  const auto windows_of = [&](double length) {
    return fitter.prepare(make_windows(problem, false, length, criteria().step_n_windows), {}, false);
  };
  if (!problem.can_restart) return windows_of(0);
  const bool has_pictures = !problem.recording.mask_sources.empty() || !problem.recording.video_sources.empty();
  const bool are_short = !has_pictures && std::all_of(problem.runs.begin(), problem.runs.end(), [](const Run& run) {
    return run.t.back() - run.t.front() <= criteria().whole_run_longest;
  });
  if (are_short)
    if (FitData runs = windows_of(0);
        !runs.windows.empty() && std::all_of(runs.of_start.begin(), runs.of_start.end(), [](const Eigen::MatrixXd& u) {
          return start_growth(u) <= criteria().whole_run_growth;
        }))
      return runs;
  return windows_of(criteria().step_window);
}

constexpr auto BDF2 = SolverSettings::Integrator::bdf2;

// One choice, from the scene's own step on: compared with finer ones, refined or extrapolated, corrected.
class StepChoice {
 public:
  StepChoice(Fitter& fitter, Predictor& predictor, const Problem& problem, Variant& base)
      : fitter_(fitter),
        predictor_(predictor),
        problem_(problem),
        base_(base),
        solver_(base.scene.solver),
        is_dissipative_(dissipates(base.scene)) {
    solver_.velocity_tolerance = std::min(solver_.velocity_tolerance, criteria().newton_tolerance);
    solver_.cg_tolerance = std::min(solver_.cg_tolerance, criteria().cg_tolerance_most);
    solver_.max_step_halvings = std::min(solver_.max_step_halvings, criteria().step_n_halvings);
    as_given_ = solver_;
    was_extrapolated_ = base_.extrapolates;
    base_.extrapolates = false;
    data_ = where_steps_show(fitter, problem);
    // with soft bodies and cloth finer steps would take too long
    const bool is_stiff = base_.scene.soft_bodies.empty() && base_.scene.cloths.empty();
    const bool has_masks = !problem.recording.mask_sources.empty();
    by_pixels_ = is_stiff && has_masks;
    may_extrapolate_ = is_stiff && !has_masks && problem.recording.video_sources.empty() && problem.can_restart;
  }

  // What the reader is told of it.
  std::string make() {
    compare_as_given();
    refine();
    keep_or_take();
    correct();
    return sentence();
  }

 private:
  std::vector<Prediction> predict(const Choice& choice) {
    Variant variant = base_;
    variant.scene.solver.integrator = choice.integrator;
    variant.scene.solver.time_step = choice.time_step;
    std::vector<Job> jobs;
    for (const Window& window : data_.windows) jobs.push_back({&variant, &window, window.initial, false});
    return predictor_.predict(jobs);
  }

  double allowed() const {  // [noise]
    return by_pixels_                                      ? criteria().step_error_most_masks
           : is_dissipative_ && order_of_steps(base_) == 1 ? criteria().step_error_most_dissipative
                                                           : criteria().step_error_most;
  }
  double small() const { return by_pixels_ ? criteria().step_error_pixels : allowed(); }
  StepError error_by(double factor) const { return error_of(problem_, data_, factor, coarse_, fine_); }

  // The scene's own step and integrator with second order at half the step; with second order at the whole one if that
  // shows.
  void compare_as_given() {
    const double h = solver_.time_step;
    fine_ = predict({BDF2, h / 2});
    coarse_ = predict({solver_.integrator, h});
    misfit_as_given_ = misfit(data_, coarse_);
    error_ = error_by(is_dissipative_ ? 2 : 1);
    is_as_given_ = is_below(error_, allowed());
    if (is_as_given_) return;
    if (solver_.integrator != BDF2) coarse_ = predict({BDF2, h});
    solver_.integrator = BDF2;
    error_ = error_by(richardson_factor(order_of_steps(base_)));
  }

  void refine() {
    const double most = allowed(), enough = small();
    order_ = order_of_steps(base_);
    for (int halving = 0; !is_below(error_, most) && converges_ && halving < criteria().step_n_refinements; ++halving) {
      const double before = error_.all;
      solver_.time_step /= 2;
      const std::vector<Prediction> coarser = std::exchange(coarse_, std::move(fine_));
      fine_ = predict({BDF2, solver_.time_step / 2});
      error_ = error_by(richardson_factor(order_));
      converges_ = error_.all < std::max(enough, criteria().step_converges * before);
      // two steps twice and four times as long as the next ones cost three quarters of it, and give more
      if (!may_extrapolate_ || !converges_ || (is_below(error_, most) && !was_extrapolated_)) continue;
      of_limits_.push_back(
          most_apart(data_, extrapolated(coarser, coarse_, order_), extrapolated(coarse_, fine_, order_)));
      const double of_limit = richardson_factor(order_ + 1) * of_limits_.back();
      if (of_limit >= std::min(most, criteria().step_error_most_extrapolated)) continue;
      base_.extrapolates = true;
      solver_.time_step *= 2;
      error_ = {of_limit, of_limit};
    }
    is_small_ = is_below(error_, enough);
  }

  // Where finer steps neither converge nor come nearer to what was measured, the scene's own is part of its model.
  void keep_or_take() {
    const bool is_nearer = misfit(data_, fine_) < misfit_as_given_;
    keeps_as_given_ = !is_small_ && !(converges_ && is_nearer);
    if (keeps_as_given_) {
      solver_ = as_given_;
      fitter_.take_steps_as_they_are();
    }
    if (by_pixels_) fitter_.expect_whole_pixels();
  }

  void correct() {
    fitter_.correct_steps_by(std::nullopt);
    // coarse steps have not reached the third order yet
    if (base_.extrapolates && of_limits_.size() > 1 && of_limits_.back() > 0)
      fitter_.correct_steps_by(
          measured_richardson_factor(of_limits_[of_limits_.size() - 2] / of_limits_.back(), std::exp2(order_ + 1)));
    // of light damping the error is still of second order
    if (is_dissipative_ && solver_.integrator == BDF2 && !keeps_as_given_ && !by_pixels_ && !base_.extrapolates) {
      const double first = apart(data_, predict({BDF2, solver_.time_step}), fine_);
      const double second = apart(data_, fine_, predict({BDF2, solver_.time_step / 4}));
      if (second > 0 && std::isfinite(first)) fitter_.correct_steps_by(measured_richardson_factor(first / second, 4));
    }
  }

  std::string sentence() const {
    if (base_.extrapolates)
      return fmt::format(
          "simulated with steps of {:.4g} and {:.4g} ms, BDF2, extrapolated to no length, since the scene's own step "
          "would be taken for an effect; finer steps differ by {:.2g} times the noise, which is corrected",
          1e3 * solver_.time_step, 5e2 * solver_.time_step, error_.all);
    return fmt::format(
        "simulated with steps of {:.4g} ms, {}, {}; finer steps differ by {:.2g} times the noise, {}",
        1e3 * solver_.time_step, solver_.integrator == BDF2 ? "BDF2" : "implicit Euler",
        is_as_given_ || keeps_as_given_ ? "as the scene says" : "since the scene's own would be taken for an effect",
        error_.all, what_of_the_error());
  }

  const char* what_of_the_error() const {
    if (is_small_) return by_pixels_ ? "whole pixels among it, which is not corrected" : "which is corrected";
    if (!keeps_as_given_) return "which is too much to be corrected: what depends on it is not known";
    return converges_
               ? "and are farther from what was measured: the step is part of the scene's model"
               : "and do not come nearer to each other, as in hard impacts: the step is part of the scene's model";
  }

  Fitter& fitter_;
  Predictor& predictor_;
  const Problem& problem_;
  Variant& base_;
  SolverSettings& solver_;  // the base's
  SolverSettings as_given_;
  FitData data_;  // where steps are compared
  std::vector<Prediction> coarse_, fine_;
  std::vector<double> of_limits_;  // changes of what two steps extrapolate, by each halving [noise]
  StepError error_;
  double misfit_as_given_ = 0;
  int order_ = 0;  // of convergence
  bool is_dissipative_, by_pixels_ = false, may_extrapolate_ = false, was_extrapolated_ = false, is_as_given_ = false,
                        converges_ = true, is_small_ = false, keeps_as_given_ = false;
};

}  // namespace

double measured_richardson_factor(double ratio, double most) {
  const double by = std::clamp(ratio, 2.0, most);
  return by / (by - 1);
}

std::string choose_time_step(Fitter& fitter, Predictor& predictor, const Problem& problem, Variant& base) {
  return StepChoice(fitter, predictor, problem, base).make();
}

}  // namespace pvg::diagnose
