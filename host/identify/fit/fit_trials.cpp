// One Gauss-Newton step of a fit, as trials. Where the full step lowers the cost by less than what is predicted,
//   C(x) - C(x + dx) < 3/4 (C(x) - C_linear(x + dx)),
// several dampings are tried too, and in each a full and a damped step of the windows' starts: moves of a body into the
// floor and along it can cancel, so that a full step of the starts may go far without changing the residuals.
#include <algorithm>
#include <cmath>
#include <limits>

#include "host/identify/criteria.hpp"
#include "host/identify/fit/fit.hpp"
#include "host/identify/fit/fit_cost.hpp"
#include "host/identify/fit/normal_equations.hpp"
#include "host/identify/fit/prior.hpp"

namespace pvg::diagnose {
namespace {

using Eigen::MatrixXd, Eigen::VectorXd;
constexpr double LEAST_DAMPING = 1e-12;  // of numbers that move the data alike

VectorXd clamped(const Model& model, VectorXd x) {
  const std::vector<const Parameter*> parameters = model.parameters();
  for (Eigen::Index i = 0; i < x.size(); ++i)
    x[i] = std::clamp(x[i], parameters[std::size_t(i)]->low, parameters[std::size_t(i)]->high);
  return x;
}

// A positive number that may be far off goes in its logarithm, and not farther than a linear model may reach.
VectorXd moved(const Model& model, const VectorXd& dx) {
  const std::vector<const Parameter*> parameters = model.parameters();
  const double most = criteria().log_step_most;
  VectorXd x = model.x + dx;
  for (Eigen::Index i = 0; i < x.size(); ++i)
    if (parameters[std::size_t(i)]->is_logarithmic)
      x[i] = model.x[i] * std::exp(std::clamp(dx[i] / model.x[i], -most, most));
  return x;
}

// The change of a window's residuals that the linear system predicts.
VectorXd predicted_change(const Fit& fit, std::size_t w, const VectorXd& x, const VectorXd& delta) {
  VectorXd change = VectorXd::Zero(fit.residual[w].size());
  if (delta.size() > 0) change += fit.of_start[w] * (delta - fit.delta[w]);
  if (x != fit.model.x) change += fit.slope[w] * (x - fit.model.x);
  return change;
}

// Whether the residuals of a window came out as predicted, where its start matters.
bool is_as_predicted(const Fit& fit, std::size_t w, const VectorXd& x, const VectorXd& delta,
                     const VectorXd& residual) {
  if (delta.size() == 0) return true;
  const VectorXd predicted = predicted_change(fit, w, x, delta), change = residual - fit.residual[w];
  return rms({change - predicted}) <=
         std::max(criteria().reduction_missed * rms({change}), criteria().reduction_missed_floor);
}

bool any_at_bound(const Model& model) {
  const std::vector<const Parameter*> parameters = model.parameters();
  for (std::size_t i = 0; i < parameters.size(); ++i)
    if (const double x = model.x[Eigen::Index(i)]; x == parameters[i]->low || x == parameters[i]->high) return true;
  return false;
}

// Whether a full step that no bound shortens lowers the cost by nearly as much as predicted: no damped one goes much
// farther down.
bool is_enough(const Fit& fit, const Model& model, const std::vector<VectorXd>& delta,
               const std::vector<Prediction>& found) {
  double cost = prior_cost(model) + start_cost(delta), predicted = cost;
  for (std::size_t w = 0; w < found.size(); ++w) {
    if (!found[w].succeeded) return false;
    cost += robust_cost({found[w].residual}, scale_of(fit, w));
    const VectorXd there = fit.residual[w] + predicted_change(fit, w, model.x, delta[w]);
    predicted += robust_cost({there}, scale_of(fit, w));
  }
  return !any_at_bound(model) && cost < fit.cost &&
         fit.cost - cost >= criteria().step_gain_least * (fit.cost - predicted);
}

// The model after one damped Gauss-Newton step; unchanged where the step is not finite.
Model stepped(const Fit& fit, double damping) {
  const Reduced reduced = reduce(fit);
  MatrixXd a = reduced.sum_a();
  VectorXd g = reduced.sum_g();
  const std::vector<const Parameter*> parameters = fit.model.parameters();
  for (Eigen::Index i = 0; i < g.size(); ++i) {
    const Parameter& p = *parameters[std::size_t(i)];
    const double weight = prior_weight(p, fit.model.x[i]);
    a(i, i) += weight;
    g[i] += weight * (fit.model.x[i] - p.off);
  }
  add_to_diagonal(a, damping + LEAST_DAMPING);
  const VectorXd dx = -a.ldlt().solve(g);
  Model model = fit.model;
  if (dx.allFinite()) model.x = clamped(model, moved(model, dx));
  return model;
}

}  // namespace

void Fitter::add_trials(const Fit& fit, std::size_t owner, bool only_starts, Steps steps, Trials& trials) const {
  const bool moves_model = fit.model.x.size() > 0 && !only_starts;
  const Series dampings = moves_model ? criteria().fit_dampings : Series{0};
  for (const double damping : dampings) {
    const Model model = moves_model ? stepped(fit, damping) : fit.model;
    const VectorXd dx = moves_model ? VectorXd(model.x - fit.model.x) : VectorXd();
    for (const double start_damping : {0.0, criteria().start_damping}) {
      const bool is_full = damping == dampings[0] && start_damping == 0;
      if (is_full != (steps == Steps::full)) continue;
      std::vector<VectorXd> delta = fit.delta;
      bool any_moves = false;
      for (std::size_t w = 0; w < delta.size(); ++w)
        if (delta[w].size() > 0) {
          delta[w] += best_start(fit, w, dx, start_damping);
          any_moves = true;
        }
      if (start_damping == 0 || any_moves) trials.add(model, std::move(delta), owner);
    }
  }
}

void Fitter::simulate(const FitData& data, Trials& trials) {
  Trials open;
  for (std::size_t t = 0; t < trials.models.size(); ++t)
    if (trials.found[t].empty()) open.add(trials.models[t], trials.delta[t], t);
  std::vector<std::vector<Prediction>> found = evaluate(data, open.models, open.delta);
  for (std::size_t i = 0; i < found.size(); ++i) trials.found[open.owner[i]] = std::move(found[i]);
}

// The full steps, and the damped ones of each fit whose full one is not enough; all simulated.
Fitter::Trials Fitter::steps_of(const FitData& data, const std::vector<Fit>& fits, bool only_starts) {
  Trials full, all;
  for (std::size_t m = 0; m < fits.size(); ++m)
    if (fits[m].is_open()) add_trials(fits[m], m, only_starts, Steps::full, full);
  simulate(data, full);
  for (std::size_t t = 0; t < full.models.size(); ++t) {
    const Fit& fit = fits[full.owner[t]];
    const bool is_done = is_enough(fit, full.models[t], full.delta[t], full.found[t]);
    all.add(full.models[t], std::move(full.delta[t]), full.owner[t], std::move(full.found[t]));
    if (!is_done) add_trials(fit, full.owner[t], only_starts, Steps::damped, all);
  }
  simulate(data, all);
  return all;
}

// Each model of the trials once, with the best residuals of each window: for one model the windows are independent, so
// each takes the start that is best for it.
std::vector<Fitter::Attempt> Fitter::attempts_of(const Trials& trials, const std::vector<Fit>& fits) {
  const std::vector<std::vector<Prediction>>& found = trials.found;
  std::vector<Attempt> attempts;
  for (std::size_t first = 0, last = 0; first < found.size(); first = last) {
    const Fit& fit = fits[trials.owner[first]];
    while (last < found.size() && trials.owner[last] == trials.owner[first] &&
           trials.models[last].x == trials.models[first].x)
      ++last;
    const std::size_t n_windows = fit.residual.size();
    Attempt attempt{trials.models[first], std::vector<VectorXd>(n_windows), std::vector<VectorXd>(n_windows),
                    trials.owner[first], prior_cost(trials.models[first])};
    const bool is_same_model = attempt.model.x == fit.model.x;
    for (std::size_t w = 0; w < n_windows; ++w) {
      double least = std::numeric_limits<double>::infinity();
      const auto take = [&](const VectorXd& r, const VectorXd& d) {
        const double cost = robust_cost({r}, scale_of(fit, w)) + start_cost({d});
        if (!(cost < least)) return;
        least = cost;
        attempt.residual[w] = r;
        attempt.delta[w] = d;
      };
      if (is_same_model) take(fit.residual[w], fit.delta[w]);
      for (std::size_t t = first; t < last; ++t)
        if (found[t][w].succeeded) take(found[t][w].residual, trials.delta[t][w]);
      attempt.cost += least;
    }
    if (std::isfinite(attempt.cost)) attempts.push_back(std::move(attempt));
  }
  return attempts;
}

// Where the actual change of a step differs from the predicted one, its starts are not the best ones: each is corrected
// by the remaining residuals and the known sensitivities, so that the step follows a curved valley.
Fitter::Trials Fitter::corrected(const std::vector<Attempt>& attempts, const std::vector<Fit>& fits) const {
  Trials trials;
  for (const Attempt& attempt : attempts) {
    const Fit& fit = fits[attempt.owner];
    Fit there = fit;
    there.residual = attempt.residual;
    there.delta = attempt.delta;
    bool any_broken = false;
    std::vector<VectorXd> delta = attempt.delta;
    for (std::size_t w = 0; w < delta.size(); ++w) {
      if (is_as_predicted(fit, w, attempt.model.x, attempt.delta[w], attempt.residual[w])) continue;
      any_broken = true;
      delta[w] += best_start(there, w, VectorXd());
    }
    if (any_broken) trials.add(attempt.model, std::move(delta), attempt.owner);
  }
  return trials;
}

// Moves each fit to its best attempt if that lowers its cost. Returns which fits moved.
std::vector<char> Fitter::take_best(const FitData& data, const Trials& trials, std::vector<Fit>& fits) {
  std::vector<Attempt> attempts = attempts_of(trials, fits);
  Trials again = corrected(attempts, fits);
  simulate(data, again);
  for (Attempt& attempt : attempts_of(again, fits)) attempts.push_back(std::move(attempt));
  std::vector<char> is_better(fits.size(), false);
  for (std::size_t m = 0; m < fits.size(); ++m) {
    Fit& fit = fits[m];
    Attempt* best = nullptr;
    for (Attempt& attempt : attempts)
      if (attempt.owner == m && (best == nullptr || attempt.cost < best->cost)) best = &attempt;
    if (best == nullptr) continue;
    is_better[m] = best->cost < fit.cost;
    for (std::size_t w = 0; w < data.windows.size(); ++w) {
      const bool is_kept = is_as_predicted(fit, w, best->model.x, best->delta[w], best->residual[w]);
      if (is_better[m])
        fit.start_slope[w] = is_kept ? StartSlope::near : StartSlope::stale;
      else if (!is_kept && fit.start_slope[w] == StartSlope::near)
        fit.start_slope[w] = StartSlope::stale;
    }
    if (!is_better[m]) continue;
    fit.cost = best->cost;
    fit.model = std::move(best->model);
    fit.delta = std::move(best->delta);
    fit.residual = std::move(best->residual);
  }
  return is_better;
}

std::vector<std::vector<VectorXd>> Fitter::predicted(const FitData& data, std::vector<Fit>& fits) {
  differentiate(data, fits, Which::open);
  std::vector<std::vector<VectorXd>> residuals;
  for (const Fit& fit : fits) {
    residuals.push_back(fit.residual);
    if (!fit.succeeded || fit.is_stale || fit.model.x.size() == 0) continue;
    const VectorXd dx = stepped(fit, 0).x - fit.model.x;
    for (std::size_t w = 0; w < fit.residual.size(); ++w) {
      residuals.back()[w] += fit.slope[w] * dx;
      if (fit.delta[w].size() > 0) residuals.back()[w] += fit.of_start[w] * best_start(fit, w, dx);
    }
  }
  return residuals;
}

}  // namespace pvg::diagnose
