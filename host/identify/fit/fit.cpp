#include "host/identify/fit/fit.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "host/identify/criteria.hpp"
#include "host/identify/fit/correlation.hpp"
#include "host/identify/fit/fit_cost.hpp"

namespace pvg::diagnose {
namespace {

using Eigen::MatrixXd, Eigen::VectorXd;

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

// Whether the residuals of a window came out as the linear system predicted, where its start matters.
bool is_as_predicted(const Fit& fit, std::size_t w, const VectorXd& x, const VectorXd& delta,
                     const VectorXd& residual) {
  if (delta.size() == 0) return true;
  VectorXd predicted = fit.of_start[w] * (delta - fit.delta[w]);
  if (x != fit.model.x) predicted += fit.slope[w] * (x - fit.model.x);
  const VectorXd change = residual - fit.residual[w];
  return rms({change - predicted}) <=
         std::max(criteria().reduction_missed * rms({change}), criteria().reduction_missed_floor);
}

// The model after one damped Gauss-Newton step; unchanged where the step is not finite.
Model stepped(const Fit& fit, double damping) {
  const Reduced reduced = reduce(fit);
  MatrixXd a = reduced.sum_a();
  VectorXd g = reduced.sum_g();
  const std::vector<const Parameter*> parameters = fit.model.parameters();
  for (Eigen::Index i = 0; i < g.size(); ++i) {
    const Parameter& p = *parameters[std::size_t(i)];
    const double weight = 1 / (prior_sigma_of(p) * prior_sigma_of(p));
    a(i, i) += weight;
    g[i] += weight * (fit.model.x[i] - p.off);
  }
  a.diagonal() += VectorXd(damping * a.diagonal() + VectorXd::Constant(a.rows(), 1e-12 * a.trace()));
  const VectorXd dx = -a.ldlt().solve(g);
  Model model = fit.model;
  if (dx.allFinite()) model.x = clamped(model, moved(model, dx));
  return model;
}

bool any_start_is_stale(const Fit& fit) {
  return std::find(fit.start_slope.begin(), fit.start_slope.end(), StartSlope::stale) != fit.start_slope.end();
}

}  // namespace

std::vector<const Parameter*> Model::parameters() const {
  std::vector<const Parameter*> all;
  for (const Candidate* part : parts)
    for (const Parameter& p : part->parameters) all.push_back(&p);
  return all;
}

std::vector<const Candidate*> Model::effects() const { return {parts.begin() + n_nuisances(), parts.end()}; }

Eigen::Index Model::n_nuisances() const {
  return std::count_if(parts.begin(), parts.end(), [](const Candidate* part) { return part->is_nuisance; });
}

Model model_of(const std::vector<const Candidate*>& parts) {
  Model model{parts, {}, {}};
  const std::vector<const Parameter*> parameters = model.parameters();
  model.x.resize(Eigen::Index(parameters.size()));
  model.scale.resize(model.x.size());
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    model.x[Eigen::Index(i)] = parameters[i]->off;
    model.scale[Eigen::Index(i)] = parameters[i]->scale;
  }
  return model;
}

Model joined(const Model& first, const Model& second) {
  Model both{first.parts, VectorXd(first.x.size() + second.x.size()), VectorXd(first.x.size() + second.x.size())};
  both.parts.insert(both.parts.end(), second.parts.begin(), second.parts.end());
  both.x << first.x, second.x;
  both.scale << first.scale, second.scale;
  return both;
}

Variant variant_of(const Variant& base, const Model& model) {
  Variant variant = base;
  std::size_t first = 0;
  for (const Candidate* part : model.parts) {
    part->apply(variant, std::span<const double>(model.x.data() + first, part->parameters.size()));
    first += part->parameters.size();
  }
  return variant;
}

std::vector<std::vector<Prediction>> Fitter::evaluate(const FitData& data, const std::vector<Model>& models,
                                                      const std::vector<std::vector<VectorXd>>& delta,
                                                      bool wants_phases) {
  std::vector<Variant> variants;
  for (const Model& model : models) variants.push_back(variant_of(base_, model));
  std::vector<Job> jobs;
  for (std::size_t m = 0; m < models.size(); ++m)
    for (std::size_t w = 0; w < data.windows.size(); ++w) {
      Job job{&variants[m], &data.windows[w], data.windows[w].initial, wants_phases};
      if (!delta.empty())
        for (std::size_t k = 0; k < job.window->unknowns.size(); ++k)
          move(job.initial, job.window->unknowns[k], delta[m][w][Eigen::Index(k)] * job.window->unknowns[k].sigma);
      jobs.push_back(std::move(job));
    }
  std::vector<Prediction> flat = predictor_.predict(jobs);
  std::vector<std::vector<Prediction>> out(models.size());
  for (std::size_t i = 0; i < flat.size(); ++i) out[i / data.windows.size()].push_back(std::move(flat[i]));
  return out;
}

// One Gauss-Newton step of one fit with several dampings, as trials. In each, the windows' starts take a full and a
// damped step: moves of a body into the floor and along it can cancel, so that a full step of the starts may go far
// without changing the residuals.
void Fitter::add_trials(const Fit& fit, std::size_t owner, bool only_starts, Trials& trials) const {
  const bool moves_model = fit.model.x.size() > 0 && !only_starts;
  for (const double damping : moves_model ? criteria().fit_dampings : Series{0}) {
    const Model model = moves_model ? stepped(fit, damping) : fit.model;
    const VectorXd dx = moves_model ? VectorXd(model.x - fit.model.x) : VectorXd();
    for (const double start_damping : {0.0, criteria().start_damping}) {
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

// Each model of the trials once, with the best residuals of each window: for one model the windows are independent, so
// each takes the start that is best for it.
std::vector<Fitter::Attempt> Fitter::attempts_of(const FitData& data, const Trials& trials,
                                                 const std::vector<Fit>& fits) {
  const std::vector<std::vector<Prediction>> found = evaluate(data, trials.models, trials.delta);
  const std::size_t n_windows = data.windows.size();
  std::vector<Attempt> attempts;
  for (std::size_t first = 0, last = 0; first < found.size(); first = last) {
    const Fit& fit = fits[trials.owner[first]];
    while (last < found.size() && trials.owner[last] == trials.owner[first] &&
           trials.models[last].x == trials.models[first].x)
      ++last;
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
  std::vector<Attempt> attempts = attempts_of(data, trials, fits);
  const Trials again = corrected(attempts, fits);
  for (Attempt& attempt : attempts_of(data, again, fits)) attempts.push_back(std::move(attempt));
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

std::vector<Fit> Fitter::begin(const FitData& data, std::vector<Model> models, std::vector<VectorXd> starts) {
  std::vector<Fit> fits(models.size());
  StartSlope slope_there = StartSlope::near;
  if (starts.empty()) {
    slope_there = StartSlope::here;
    for (const Window& window : data.windows) starts.push_back(VectorXd::Zero(Eigen::Index(window.unknowns.size())));
  }
  std::vector<std::vector<Prediction>> found = evaluate(data, models, std::vector(models.size(), starts));
  for (std::size_t m = 0; m < models.size(); ++m) {
    const bool is_there = models[m].parts == data.at.parts && models[m].x == data.at.x;
    fits[m].of_start = data.of_start;
    fits[m].start_slope.assign(data.windows.size(), is_there ? slope_there : StartSlope::stale);
    fits[m].model = std::move(models[m]);
    fits[m].delta = starts;
    fits[m].succeeded = true;
    for (Prediction& p : found[m]) {
      fits[m].succeeded = fits[m].succeeded && p.succeeded;
      fits[m].residual.push_back(std::move(p.residual));
    }
  }
  return fits;
}

void Fitter::improve(const FitData& data, std::vector<Fit>& fits, int n_steps, Scale scale, bool only_starts) {
  for (int step = 0; step < n_steps; ++step) {
    differentiate(data, fits, only_starts ? Which::open_starts : Which::open);
    Trials trials;
    std::vector<double> before(fits.size());
    for (std::size_t m = 0; m < fits.size(); ++m) {
      Fit& fit = fits[m];
      if (!fit.succeeded || fit.has_converged || fit.is_given_up) continue;
      fit.scale = robust_scale(fit.residual);
      fit.window_scale = scale == Scale::of_window ? window_scales(fit.residual) : std::vector<double>();
      before[m] = fit.cost = cost_of(fit);
      add_trials(fit, m, only_starts, trials);
    }
    if (trials.models.empty()) return;
    const std::vector<char> is_better = take_best(data, trials, fits);
    for (std::size_t m = 0; m < fits.size(); ++m) {
      Fit& fit = fits[m];
      if (!fit.succeeded || fit.has_converged || fit.is_given_up) continue;
      fit.is_stale = fit.is_stale || is_better[m];
      fit.has_converged =
          is_better[m] ? before[m] - fit.cost <= criteria().fit_small_change * before[m] : !any_start_is_stale(fit);
    }
  }
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

void Fitter::take_last_steps(const FitData& data, std::vector<Fit>& fits) {
  for (Fit& fit : fits) {
    const std::vector<double> scales = window_scales(fit.residual);
    const bool any_missed = std::any_of(scales.begin(), scales.end(), [&](double s) {
      return s > criteria().window_scale_missed * robust_scale(fit.residual);
    });
    fit.has_converged = !any_missed;
  }
  improve(data, fits, criteria().n_last_steps, Scale::of_all);
}

void Fitter::finish(const FitData& data, std::vector<Fit>& fits) {
  take_last_steps(data, fits);
  conclude(data, fits);
}

void Fitter::conclude(const FitData& data, std::vector<Fit>& fits) {
  differentiate(data, fits, Which::all);
  for (Fit& fit : fits) {
    if (!fit.succeeded) continue;
    fit.scale = robust_scale(fit.residual);
    fit.window_scale.clear();
    fit.cost = cost_of(fit);
    fit.covariance = covariance_of(fit, data.windows, correlation_length(data.windows, fit.residual));
  }
}

std::vector<Fit> Fitter::fit(const FitData& data, std::vector<Model> models, int n_steps) {
  std::vector<Fit> fits = begin(data, std::move(models));
  const bool any_unknown = std::any_of(data.windows.begin(), data.windows.end(),
                                       [](const Window& window) { return !window.unknowns.empty(); });
  if (n_steps == 0) {
    if (any_unknown) improve(data, fits, criteria().n_start_steps, Scale::of_window, true);
    return fits;
  }
  improve(data, fits, n_steps);
  finish(data, fits);
  return fits;
}

}  // namespace pvg::diagnose
