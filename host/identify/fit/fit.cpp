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
    std::vector<double> before(fits.size());
    for (std::size_t m = 0; m < fits.size(); ++m) {
      Fit& fit = fits[m];
      if (!fit.is_open()) continue;
      fit.scale = robust_scale(fit.residual);
      fit.window_scale = scale == Scale::of_window ? window_scales(fit.residual) : std::vector<double>();
      before[m] = fit.cost = cost_of(fit);
    }
    const Trials trials = steps_of(data, fits, only_starts);
    if (trials.models.empty()) return;
    const std::vector<char> is_better = take_best(data, trials, fits);
    for (std::size_t m = 0; m < fits.size(); ++m) {
      Fit& fit = fits[m];
      if (!fit.is_open()) continue;
      fit.is_stale = fit.is_stale || is_better[m];
      fit.has_converged =
          is_better[m] ? before[m] - fit.cost <= criteria().fit_small_change * before[m] : !any_start_is_stale(fit);
    }
  }
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
