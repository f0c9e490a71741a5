#include "host/identify/search/screen_trials.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "host/identify/criteria.hpp"

namespace pvg::diagnose {
using Eigen::MatrixXd, Eigen::VectorXd;

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
                                const std::vector<const Candidate*>& candidates, double response_off_most,
                                std::vector<std::vector<VectorXd>>* known) {
  std::vector<Trial> trials;
  for (const Candidate* candidate : candidates)
    for (std::size_t i = 0; i < candidate->parameters.size(); ++i)
      trials.push_back({candidate, i, allowed(candidate->parameters[i], candidate->parameters[i].scale)});
  Fit few = base;
  const FitData some = some_windows(data, criteria().screen_n_windows, few);
  const bool may_keep = known != nullptr && some.windows.size() == data.windows.size();
  if (known != nullptr) known->assign(trials.size(), {});
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
      const double off_most = is_last ? response_off_most * response_off_most : response_off_most;
      if (may_keep && size >= criteria().sensitivity_least && std::max(factor, 1 / factor) < off_most) {
        (*known)[open[k]] = found[k];
        continue;
      }
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

namespace {

struct Shaped {
  std::vector<Eigen::Index> strength;  // in the candidate's parameters
  Eigen::Index shape = -1;
  bool is_of_several() const { return shape >= 0 && strength.size() > 1; }
};

Shaped law_of(const Candidate& candidate) {
  Shaped law;
  for (std::size_t k = 0; k < candidate.parameters.size(); ++k) {
    if (candidate.parameters[k].is_shape)
      law.shape = Eigen::Index(k);
    else
      law.strength.push_back(Eigen::Index(k));
  }
  return law;
}

std::vector<double> shapes_of(const Parameter& p) {
  std::vector<double> shapes = {p.off};
  for (const double factor : criteria().screen_shapes) shapes.push_back(factor * p.off);
  std::erase_if(shapes, [&](double shape) { return shape < p.low || shape > p.high; });
  return shapes;
}

// Residuals of all windows, starts eliminated, each window over its scale in the base.
VectorXd stacked(const FitData& some, const std::vector<double>& scales, const std::vector<Prediction>& found) {
  std::vector<VectorXd> parts;
  Eigen::Index n = 0;
  for (std::size_t w = 0; w < found.size(); ++w) {
    parts.push_back(beside_starts(some.of_start[w], found[w].residual) / scales[w]);
    n += parts.back().size();
  }
  VectorXd all(n);
  n = 0;
  for (const VectorXd& part : parts) {
    all.segment(n, part.size()) = part;
    n += part.size();
  }
  return all;
}

bool have_succeeded(const std::vector<Prediction>& found) {
  return std::all_of(found.begin(), found.end(), [](const Prediction& p) { return p.succeeded; });
}

// Which of several models leaves least, and what it leaves; nothing where none could be simulated.
struct Nearest {
  std::size_t number;
  VectorXd left;
};

std::optional<Nearest> nearest_of(const FitData& some, const std::vector<double>& scales,
                                  const std::vector<std::vector<Prediction>>& found) {
  std::optional<Nearest> nearest;
  for (std::size_t m = 0; m < found.size(); ++m) {
    if (!have_succeeded(found[m])) continue;
    VectorXd left = stacked(some, scales, found[m]);
    if (!nearest || left.squaredNorm() < nearest->left.squaredNorm()) nearest = Nearest{m, std::move(left)};
  }
  return nearest;
}

// The strengths of a law of several places, within the parameters of a model.
struct Strengths {
  const std::vector<Parameter>& parameters;  // of the candidate
  Shaped law;
  Eigen::Index n_base;  // parameters of the model before those of the candidate

  Eigen::Index n() const { return Eigen::Index(law.strength.size()); }
  Eigen::Index place(Eigen::Index i) const { return n_base + law.strength[std::size_t(i)]; }
  Eigen::Index shape_place() const { return n_base + law.shape; }
  const Parameter& parameter(Eigen::Index i) const { return parameters[std::size_t(law.strength[std::size_t(i)])]; }
};

// The first strength alone: as it is best beside the others, and as large as they are together.
std::vector<Model> first_alone(const Model& model, const Strengths& strengths) {
  std::vector<Model> alone(2, model);
  for (Eigen::Index i = 1; i < strengths.n(); ++i) {
    alone[1].x[strengths.place(0)] += model.x[strengths.place(i)] - strengths.parameter(i).off;
    alone[0].x[strengths.place(i)] = alone[1].x[strengths.place(i)] = strengths.parameter(i).off;
  }
  return alone;
}

// The first strength moved at any shape, then each of the others at each shape.
std::vector<Model> moved_at_shapes(const Model& start, const Strengths& strengths, const VectorXd& step,
                                   const std::vector<double>& shapes) {
  std::vector<Model> moved(1, start);
  moved[0].x[strengths.place(0)] += step[0];
  for (const double shape : shapes)
    for (Eigen::Index i = 1; i < strengths.n(); ++i) {
      moved.push_back(start);
      moved.back().x[strengths.place(i)] += step[i];
      moved.back().x[strengths.shape_place()] = shape;
    }
  return moved;
}

// The change of the strengths that leaves least of `left` by the columns j, within their bounds.
VectorXd best_change(const MatrixXd& j, const VectorXd& left, const Model& start, const Strengths& strengths) {
  VectorXd low(strengths.n()), high(strengths.n());
  for (Eigen::Index i = 0; i < strengths.n(); ++i) {
    low[i] = strengths.parameter(i).low - start.x[strengths.place(i)];
    high[i] = strengths.parameter(i).high - start.x[strengths.place(i)];
  }
  MatrixXd a = j.transpose() * j;
  a.diagonal().array() += criteria().screen_ridge * a.trace();
  return least_within(a, j.transpose() * left, low, high);
}

}  // namespace

std::vector<Model> places_at_shapes(Fitter& fitter, const FitData& some, const Fit& few, const Screened& screened) {
  const std::vector<Parameter>& parameters = screened.candidate->parameters;
  const Strengths strengths{parameters, law_of(*screened.candidate),
                            screened.model.x.size() - Eigen::Index(parameters.size())};
  if (!strengths.law.is_of_several()) return {};
  const Eigen::Index n = strengths.n();
  const auto simulated = [&](const std::vector<Model>& models) {
    return fitter.evaluate(some, models, std::vector(models.size(), few.delta));
  };
  const std::vector<double> scales = window_scales(few.residual);

  const std::vector<Model> alone = first_alone(screened.model, strengths);
  const std::optional<Nearest> nearest = nearest_of(some, scales, simulated(alone));
  if (!nearest) return {};
  const Model& start = alone[nearest->number];
  const VectorXd& r = nearest->left;
  const double size = start.x[strengths.place(0)] - strengths.parameter(0).off;
  if (size == 0) return {};

  VectorXd step = VectorXd::Constant(n, criteria().screen_share_low * size);
  step[0] = criteria().difference_share * size;
  const std::vector<double> shapes = shapes_of(parameters[std::size_t(strengths.law.shape)]);
  const auto responses = simulated(moved_at_shapes(start, strengths, step, shapes));
  std::vector<Model> models;
  for (std::size_t s = 0; s < shapes.size(); ++s) {
    MatrixXd j(r.size(), n);
    bool is_known = true;
    for (Eigen::Index i = 0; i < n; ++i) {
      const std::vector<Prediction>& response =
          responses[i == 0 ? 0 : std::size_t(1 + Eigen::Index(s) * (n - 1) + i - 1)];
      is_known = is_known && have_succeeded(response);
      if (is_known) j.col(i) = (stacked(some, scales, response) - r) / step[i];
    }
    if (!is_known) continue;
    const VectorXd dx = best_change(j, r, start, strengths);
    models.push_back(start);
    for (Eigen::Index i = 0; i < n; ++i) models.back().x[strengths.place(i)] += dx[i];
    models.back().x[strengths.shape_place()] = shapes[s];
  }
  return models;
}

}  // namespace pvg::diagnose
