#include "host/identify/search/screen_trials.hpp"

#include <algorithm>
#include <cmath>

#include "host/identify/criteria.hpp"

namespace pvg::diagnose {
using Eigen::VectorXd;

namespace {

// inside the bounds, away from them where possible
double allowed(const Parameter& p, double step) {
  if (p.off + step > p.high) step = p.off - step >= p.low ? -step : p.high - p.off;
  return std::clamp(p.off + step, p.low, p.high) - p.off;
}

bool is_limit(const Candidate& candidate) {
  return candidate.parameters.size() == 1 && candidate.parameters[0].is_limit;
}

bool is_often_far(const Candidate& candidate) {
  return candidate.parameters.size() == 1 && candidate.parameters[0].is_often_far;
}

}  // namespace

Model with_candidate(const Model& base, const Candidate& candidate) { return joined(base, model_of({&candidate})); }

std::vector<std::vector<VectorXd>> responses(Fitter& fitter, const FitData& data, const Fit& base,
                                             const std::vector<Trial>& trials) {
  std::vector<Model> models;
  for (const Trial& trial : trials) {
    Model model = with_candidate(base.model, *trial.candidate);
    model.x[base.model.x.size() + Eigen::Index(trial.parameter)] += trial.step;
    models.push_back(std::move(model));
  }
  const auto found = fitter.evaluate(data, models, std::vector(models.size(), base.delta));
  std::vector<std::vector<VectorXd>> out(trials.size());
  for (std::size_t t = 0; t < trials.size(); ++t)
    for (std::size_t w = 0; w < data.windows.size(); ++w) {
      VectorXd change = found[t][w].residual - base.residual[w];
      if (!found[t][w].succeeded) change.setConstant(std::nan(""));
      out[t].push_back(std::move(change));
    }
  return out;
}

double size_of(const std::vector<VectorXd>& response) {
  const double size = rms(response);
  return std::isfinite(size) ? size : -1;
}

FitData some_windows(const FitData& data, std::size_t most, Fit& base) {
  FitData some;
  Fit fit;
  fit.model = base.model;
  const std::size_t n = std::min(most, data.windows.size());
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t w = i * data.windows.size() / n;
    some.windows.push_back(data.windows[w]);
    some.of_start.push_back(data.of_start[w]);
    fit.delta.push_back(base.delta[w]);
    fit.residual.push_back(base.residual[w]);
  }
  base = std::move(fit);
  return some;
}

std::vector<Trial> choose_steps(Fitter& fitter, const FitData& data, const Fit& base, double wanted,
                                const std::vector<const Candidate*>& candidates) {
  std::vector<Trial> trials;
  for (const Candidate* candidate : candidates)
    for (std::size_t i = 0; i < candidate->parameters.size(); ++i)
      trials.push_back({candidate, i, allowed(candidate->parameters[i], candidate->parameters[i].scale)});
  Fit few = base;
  const FitData some = some_windows(data, criteria().screen_n_windows, few);
  std::vector<std::size_t> open(trials.size());  // whose response is not of about that size
  for (std::size_t i = 0; i < open.size(); ++i) open[i] = i;
  for (const bool is_last : {false, true}) {
    std::vector<Trial> asked;
    for (const std::size_t i : open) asked.push_back(trials[i]);
    const std::vector<std::vector<VectorXd>> found = responses(fitter, some, few, asked);
    std::vector<std::size_t> still_open;
    for (std::size_t k = 0; k < open.size(); ++k) {
      Trial& trial = trials[open[k]];
      const double size = size_of(found[k]);  // negative: the change was too much to be simulated
      const double factor =
          size < 0 ? 1 / criteria().screen_factor_most
          : size < criteria().sensitivity_least
              ? criteria().screen_factor_most
              : std::clamp(wanted / size, 1 / criteria().screen_factor_most, criteria().screen_factor_most);
      if (factor <= 1 / criteria().screen_factor_most || factor >= criteria().screen_factor_most)
        still_open.push_back(open[k]);
      const bool is_seen = size >= criteria().sensitivity_least;
      const Parameter& p = trial.candidate->parameters[trial.parameter];
      // a change that no sensor sees may still be too large for the solver; one that is seen says how far to go, such
      // as beside the damping of a robot's stiff drive
      const double most = is_seen ? INFINITY : criteria().screen_factor_most * p.scale;
      trial.step = is_last && !is_seen ? 0 : allowed(p, std::clamp(factor * trial.step, -most, most));
    }
    open = std::move(still_open);
  }
  return trials;
}

std::vector<Trial> mirrored(const std::vector<Trial>& trials) {
  std::vector<Trial> out;
  for (Trial trial : trials) {
    const Parameter& p = trial.candidate->parameters[trial.parameter];
    trial.step = p.is_logarithmic ? p.off * p.off / (p.off + trial.step) - p.off : -trial.step;
    const bool is_allowed = p.off + trial.step >= p.low && p.off + trial.step <= p.high;
    if (trial.candidate->family == Family::parameter && is_allowed) out.push_back(trial);
  }
  return out;
}

bool is_tried_anyway(const Candidate& candidate) { return is_limit(candidate) || is_often_far(candidate); }

std::vector<Model> places_of(const Screened& screened, Eigen::Index n_base) {
  const std::vector<Parameter>& parameters = screened.candidate->parameters;
  std::vector<Model> models;
  const auto add = [&](const auto& value_of) {
    Model model = screened.model;
    for (std::size_t k = 0; k < parameters.size(); ++k) {
      double& x = model.x[n_base + Eigen::Index(k)];
      x = std::clamp(value_of(k, x), parameters[k].low, parameters[k].high);
    }
    models.push_back(std::move(model));
  };
  const auto share_of = [&](std::size_t k, double x, double share) {
    return parameters[k].off + share * (x - parameters[k].off);
  };
  const Criteria& c = criteria();
  for (const double share : {c.screen_share_low, 1.0, c.screen_share_high})
    add([&](std::size_t k, double x) { return share_of(k, x, share); });
  // beyond a limit the change starts from zero: no slope predicts how far to go
  for (const double limit : is_limit(*screened.candidate) ? c.screen_limits : Series())
    add([&](std::size_t k, double) { return limit * parameters[k].off; });
  for (const double factor : is_often_far(*screened.candidate) ? c.screen_factors : Series()) {
    add([&](std::size_t k, double) { return factor * parameters[k].off; });
    add([&](std::size_t k, double) { return parameters[k].off / factor; });
  }
  if (std::none_of(parameters.begin(), parameters.end(), [](const Parameter& p) { return p.is_shape; })) return models;
  const double first = screened.model.x[n_base] - parameters[0].off;
  const auto add_shape = [&](double shape, bool is_alike) {
    add([&](std::size_t k, double x) {
      if (parameters[k].is_shape) return shape * x;
      return is_alike && parameters[k].unit == parameters[0].unit ? parameters[k].off + first : x;
    });
  };
  for (const double shape : {c.screen_shape_low, c.screen_shape_high}) {
    add_shape(shape, false);
    add_shape(shape, true);
  }
  add_shape(1, true);
  for (const double shape : c.screen_shapes) add_shape(shape, true);
  return models;
}

}  // namespace pvg::diagnose
