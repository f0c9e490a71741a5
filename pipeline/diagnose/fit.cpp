#include "pipeline/diagnose/fit.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "pipeline/diagnose/fit_cost.hpp"

namespace pvg::diagnose {
namespace {

using Eigen::MatrixXd, Eigen::VectorXd;
constexpr int START_STEPS = 4;         // where only the windows' starts are fitted
constexpr double SMALL_CHANGE = 1e-3;  // of the cost, relative: the fit has converged

const std::vector<double> DAMPINGS = {1e-6, 0.5, 8};  // of a step, relative
const std::vector<double> START_DAMPINGS = {0, 0.1};  // likewise of the starts

// of a change by a thirtieth of what is worth trying, rms in units of noise; less is the solver's: what the data do not
// tell stays as it is believed
constexpr double UNSEEN = 2e-3;
constexpr double MISSED = 1.5;  // a window's scale over that of all: it is no longer fitted as others are
constexpr int LAST_STEPS = 2;   // then

VectorXd clamped(const Model& model, VectorXd x) {
  const std::vector<const Parameter*> parameters = model.parameters();
  for (Eigen::Index i = 0; i < x.size(); ++i)
    x[i] = std::clamp(x[i], parameters[std::size_t(i)]->low, parameters[std::size_t(i)]->high);
  return x;
}

}  // namespace

std::vector<const Parameter*> Model::parameters() const {
  std::vector<const Parameter*> all;
  for (const Candidate* part : parts)
    for (const Parameter& p : part->parameters) all.push_back(&p);
  return all;
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

void Fitter::differentiate(const FitData& data, std::vector<Fit>& fits, bool also_converged) {
  const auto is_wanted = [&](const Fit& fit) {
    return fit.is_well && fit.is_stale && (also_converged || !(fit.has_converged || fit.is_given_up));
  };
  std::vector<Model> moved;
  std::vector<std::vector<VectorXd>> delta;
  std::vector<double> step;
  for (std::size_t m = 0; m < fits.size(); ++m) {
    if (!is_wanted(fits[m])) continue;
    const std::vector<const Parameter*> parameters = fits[m].model.parameters();
    for (std::size_t i = 0; i < parameters.size(); ++i) {
      const Parameter& p = *parameters[i];
      const double x = fits[m].model.x[Eigen::Index(i)];
      double by = 0.03 * std::max(std::abs(x - p.off), fits[m].model.scale[Eigen::Index(i)]);
      if (x + by > p.high) by = -by;
      moved.push_back(fits[m].model);
      moved.back().x[Eigen::Index(i)] += by;
      delta.push_back(fits[m].delta);
      step.push_back(by);
    }
  }
  const std::vector<std::vector<Prediction>> found = evaluate(data, moved, delta);
  std::size_t at = 0;
  for (std::size_t m = 0; m < fits.size(); ++m) {
    if (!is_wanted(fits[m])) continue;
    fits[m].is_stale = false;
    fits[m].slope.assign(data.windows.size(), {});
    for (std::size_t w = 0; w < data.windows.size(); ++w)
      fits[m].slope[w].resize(fits[m].residual[w].size(), fits[m].model.x.size());
    for (Eigen::Index i = 0; i < fits[m].model.x.size(); ++i, ++at) {
      std::vector<VectorXd> change;
      for (std::size_t w = 0; w < data.windows.size(); ++w)
        change.push_back(found[at][w].residual - fits[m].residual[w]);
      for (std::size_t w = 0; w < data.windows.size(); ++w)
        if (change[w].allFinite() && !(rms(change) < UNSEEN))
          fits[m].slope[w].col(i) = change[w] / step[at];
        else
          fits[m].slope[w].col(i).setZero();
    }
  }
}

// One Gauss-Newton step of one fit under several dampings, as trials: each with the windows' starts moved along, in
// full and damped. A body on the floor can be thrown into it and along it so that little changes: a full step goes far
// that way.
void Fitter::add_trials(const FitData& data, const Fit& fit, std::size_t owner, bool only_starts,
                        Trials& trials) const {
  MatrixXd a;
  VectorXd g;
  if (fit.model.x.size() > 0 && !only_starts) {
    const Reduced reduced = reduce(data, fit);
    a = reduced.sum_a();
    g = reduced.sum_g();
    const std::vector<const Parameter*> parameters = fit.model.parameters();
    for (Eigen::Index i = 0; i < g.size(); ++i) {
      const Parameter& p = *parameters[std::size_t(i)];
      const double weight = 1 / (believed_of(p) * believed_of(p));
      a(i, i) += weight;
      g[i] += weight * (fit.model.x[i] - p.off);
    }
  }
  for (const double damping : a.size() > 0 ? DAMPINGS : std::vector<double>{0}) {
    Model model = fit.model;
    VectorXd dx;
    if (a.size() > 0) {
      MatrixXd damped = a;
      damped.diagonal() += damping * a.diagonal() + VectorXd::Constant(a.rows(), 1e-12 * a.trace());
      dx = -damped.ldlt().solve(g);
      if (!dx.allFinite()) continue;
      model.x = clamped(model, fit.model.x + dx);
      dx = model.x - fit.model.x;
    }
    for (const double start_damping : START_DAMPINGS) {
      std::vector<VectorXd> delta = fit.delta;
      bool any_moves = false;
      for (std::size_t w = 0; w < delta.size(); ++w)
        if (delta[w].size() > 0) {
          delta[w] += best_start(data, fit, w, dx, start_damping);
          any_moves = true;
        }
      if (start_damping == 0 || any_moves) trials.add(model, std::move(delta), owner);
    }
  }
}

// Takes the best trial of each fit that is better than where it is; which got better. Where models are the same the
// windows have nothing to do with each other: each takes the start that is best for it.
std::vector<char> Fitter::take_best(const FitData& data, const Trials& trials, std::vector<Fit>& fits) {
  std::vector<std::vector<Prediction>> found = evaluate(data, trials.models, trials.delta);
  std::vector<char> is_better(fits.size(), false);
  const std::size_t n_windows = data.windows.size();
  for (std::size_t first = 0, last = 0; first < found.size(); first = last) {
    Fit& fit = fits[trials.owner[first]];
    while (last < found.size() && trials.owner[last] == trials.owner[first] &&
           trials.models[last].x == trials.models[first].x)
      ++last;
    const bool is_same_model = trials.models[first].x == fit.model.x;
    double cost = belief_cost(trials.models[first]);
    std::vector<VectorXd> residual(n_windows), delta(n_windows);
    for (std::size_t w = 0; w < n_windows; ++w) {
      double best = std::numeric_limits<double>::infinity();
      const auto take = [&](const VectorXd& r, const VectorXd& d) {
        const double one = robust_cost({r}, scale_of(fit, w)) + start_cost({d});
        if (!(one < best)) return;
        best = one;
        residual[w] = r;
        delta[w] = d;
      };
      if (is_same_model) take(fit.residual[w], fit.delta[w]);
      for (std::size_t t = first; t < last; ++t)
        if (found[t][w].is_well) take(found[t][w].residual, trials.delta[t][w]);
      cost += best;
    }
    if (!(cost < fit.cost)) continue;
    is_better[trials.owner[first]] = true;
    fit.cost = cost;
    fit.model = trials.models[first];
    fit.delta = std::move(delta);
    fit.residual = std::move(residual);
  }
  return is_better;
}

std::vector<Fit> Fitter::begin(const FitData& data, std::vector<Model> models) {
  std::vector<Fit> fits(models.size());
  std::vector<VectorXd> zeros;
  for (const Window& window : data.windows) zeros.push_back(VectorXd::Zero(Eigen::Index(window.unknowns.size())));
  std::vector<std::vector<Prediction>> found = evaluate(data, models, std::vector(models.size(), zeros));
  for (std::size_t m = 0; m < models.size(); ++m) {
    fits[m].model = std::move(models[m]);
    fits[m].delta = zeros;
    fits[m].is_well = true;
    for (Prediction& p : found[m]) {
      fits[m].is_well = fits[m].is_well && p.is_well;
      fits[m].residual.push_back(std::move(p.residual));
    }
  }
  return fits;
}

void Fitter::improve(const FitData& data, std::vector<Fit>& fits, int n_steps, Scale scale, bool only_starts) {
  for (int step = 0; step < n_steps; ++step) {
    if (!only_starts) differentiate(data, fits, false);
    Trials trials;
    std::vector<double> before(fits.size());
    for (std::size_t m = 0; m < fits.size(); ++m) {
      Fit& fit = fits[m];
      if (!fit.is_well || fit.has_converged || fit.is_given_up) continue;
      fit.scale = robust_scale(fit.residual);
      fit.window_scale = scale == Scale::of_window ? window_scales(fit.residual) : std::vector<double>();
      before[m] = fit.cost = cost_of(fit);
      add_trials(data, fit, m, only_starts, trials);
    }
    if (trials.models.empty()) return;
    const std::vector<char> is_better = take_best(data, trials, fits);
    for (std::size_t m = 0; m < fits.size(); ++m) {
      Fit& fit = fits[m];
      if (!fit.is_well || fit.has_converged || fit.is_given_up) continue;
      fit.is_stale = fit.is_stale || is_better[m];
      fit.has_converged = !is_better[m] || before[m] - fit.cost <= SMALL_CHANGE * before[m];
    }
  }
}

void Fitter::finish(const FitData& data, std::vector<Fit>& fits) {
  for (Fit& fit : fits) {
    const std::vector<double> scales = window_scales(fit.residual);
    const bool any_missed =
        std::any_of(scales.begin(), scales.end(), [&](double s) { return s > MISSED * robust_scale(fit.residual); });
    fit.has_converged = !any_missed;
  }
  improve(data, fits, LAST_STEPS, Scale::of_all);
  conclude(data, fits);
}

void Fitter::conclude(const FitData& data, std::vector<Fit>& fits) {
  differentiate(data, fits, true);
  for (Fit& fit : fits) {
    if (!fit.is_well) continue;
    fit.scale = robust_scale(fit.residual);
    fit.window_scale.clear();
    fit.cost = cost_of(fit);
    fit.covariance = covariance_of(data, fit);
  }
}

std::vector<Fit> Fitter::fit(const FitData& data, std::vector<Model> models, int n_steps) {
  std::vector<Fit> fits = begin(data, std::move(models));
  const bool any_unknown = std::any_of(data.windows.begin(), data.windows.end(),
                                       [](const Window& window) { return !window.unknowns.empty(); });
  if (n_steps == 0) {
    if (any_unknown) improve(data, fits, START_STEPS, Scale::of_window, true);
    return fits;
  }
  improve(data, fits, n_steps);
  finish(data, fits);
  return fits;
}

}  // namespace pvg::diagnose
