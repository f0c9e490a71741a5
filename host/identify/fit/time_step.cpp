#include "host/identify/fit/time_step.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <optional>
#include <utility>

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
  const auto middle = of_window.begin() + std::ptrdiff_t(of_window.size() / 2);
  std::nth_element(of_window.begin(), middle, of_window.end());
  return *middle;
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

}  // namespace

double measured_richardson_factor(double ratio, double most) {
  const double by = std::clamp(ratio, 2.0, most);
  return by / (by - 1);
}

std::string choose_time_step(Fitter& fitter, Predictor& predictor, const Problem& problem, Variant& base) {
  SolverSettings& solver = base.scene.solver;
  solver.velocity_tolerance = std::min(solver.velocity_tolerance, criteria().newton_tolerance);
  solver.cg_tolerance = std::min(solver.cg_tolerance, criteria().cg_tolerance_most);
  solver.max_step_halvings = std::min(solver.max_step_halvings, criteria().step_n_halvings);
  const SolverSettings as_given = solver;
  const bool was_extrapolated = base.extrapolates;
  base.extrapolates = false;
  const double h = solver.time_step;
  const FitData data = where_steps_show(fitter, problem);
  const auto predict = [&](const Choice& choice) {
    Variant variant = base;
    variant.scene.solver.integrator = choice.integrator;
    variant.scene.solver.time_step = choice.time_step;
    std::vector<Job> jobs;
    for (const Window& window : data.windows) jobs.push_back({&variant, &window, window.initial, false});
    return predictor.predict(jobs);
  };
  const auto bdf2 = SolverSettings::Integrator::bdf2;
  // each choice is compared with second order at half the step
  std::vector<Prediction> fine = predict({bdf2, h / 2}), coarse = predict({solver.integrator, h});
  const double misfit_as_given = misfit(data, coarse);
  const bool is_dissipative = dissipates(base.scene);
  StepError error = error_of(problem, data, is_dissipative ? 2 : 1, coarse, fine);
  // with soft bodies and cloth finer steps would take too long
  const bool is_stiff = base.scene.soft_bodies.empty() && base.scene.cloths.empty();
  const bool has_masks = !problem.recording.mask_sources.empty(), by_pixels = is_stiff && has_masks;
  const bool may_extrapolate = is_stiff && !has_masks && problem.recording.video_sources.empty() && problem.can_restart;
  const auto allowed_of = [&](const Variant& variant) {
    return by_pixels                                        ? criteria().step_error_most_masks
           : is_dissipative && order_of_steps(variant) == 1 ? criteria().step_error_most_dissipative
                                                            : criteria().step_error_most;
  };
  const bool is_as_given = is_below(error, allowed_of(base));
  if (!is_as_given) {
    if (solver.integrator != bdf2) coarse = predict({bdf2, h});
    solver.integrator = bdf2;
    error = error_of(problem, data, richardson_factor(order_of_steps(base)), coarse, fine);
  }
  const double allowed = allowed_of(base), small = by_pixels ? criteria().step_error_pixels : allowed;
  const int order = order_of_steps(base);
  bool converges = true;
  std::vector<double> of_limits;  // changes of what two steps extrapolate, by each halving
  for (int halving = 0; !is_below(error, allowed) && converges && halving < criteria().step_n_refinements; ++halving) {
    const double before = error.all;
    solver.time_step /= 2;
    const std::vector<Prediction> coarser = std::exchange(coarse, std::move(fine));
    fine = predict({bdf2, solver.time_step / 2});
    error = error_of(problem, data, richardson_factor(order), coarse, fine);
    converges = error.all < std::max(small, criteria().step_converges * before);
    // two steps twice and four times as long as the next ones cost three quarters of it, and give more
    if (!may_extrapolate || !converges || (is_below(error, allowed) && !was_extrapolated)) continue;
    of_limits.push_back(most_apart(data, extrapolated(coarser, coarse, order), extrapolated(coarse, fine, order)));
    const double of_limit = richardson_factor(order + 1) * of_limits.back();
    if (of_limit >= std::min(allowed, criteria().step_error_most_extrapolated)) continue;
    base.extrapolates = true;
    solver.time_step *= 2;
    error = {of_limit, of_limit};
  }
  const bool is_small = is_below(error, small), is_nearer = misfit(data, fine) < misfit_as_given;
  const bool keeps_as_given = !is_small && !(converges && is_nearer);
  if (keeps_as_given) {
    solver = as_given;
    fitter.take_steps_as_they_are();
  }
  if (by_pixels) fitter.expect_whole_pixels();
  fitter.correct_steps_by(std::nullopt);
  // coarse steps have not reached the third order yet
  if (base.extrapolates && of_limits.size() > 1 && of_limits.back() > 0)
    fitter.correct_steps_by(
        measured_richardson_factor(of_limits[of_limits.size() - 2] / of_limits.back(), std::exp2(order + 1)));
  // of light damping the error is still of second order
  if (is_dissipative && solver.integrator == bdf2 && !keeps_as_given && !by_pixels && !base.extrapolates) {
    const double first = apart(data, predict({bdf2, solver.time_step}), fine);
    const double second = apart(data, fine, predict({bdf2, solver.time_step / 4}));
    if (second > 0 && std::isfinite(first)) fitter.correct_steps_by(measured_richardson_factor(first / second, 4));
  }
  if (base.extrapolates)
    return fmt::format(
        "simulated with steps of {:.4g} and {:.4g} ms, BDF2, extrapolated to no length, since the scene's own step "
        "would "
        "be taken for an effect; finer steps differ by {:.2g} times the noise, which is corrected",
        1e3 * solver.time_step, 5e2 * solver.time_step, error.all);
  return fmt::format(
      "simulated with steps of {:.4g} ms, {}, {}; finer steps differ by {:.2g} times the noise, {}",
      1e3 * solver.time_step, solver.integrator == bdf2 ? "BDF2" : "implicit Euler",
      is_as_given || keeps_as_given ? "as the scene says" : "since the scene's own would be taken for an effect",
      error.all,
      is_small          ? (by_pixels ? "whole pixels among it, which is not corrected" : "which is corrected")
      : !keeps_as_given ? "which is too much to be corrected: what depends on it is not known"
      : converges       ? "and are farther from what was measured: the step is part of the scene's model"
                  : "and do not come nearer to each other, as in hard impacts: the step is part of the scene's model");
}

}  // namespace pvg::diagnose
