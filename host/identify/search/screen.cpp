#include "host/identify/search/screen.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <span>
#include <tuple>

#include "host/identify/criteria.hpp"
#include "host/identify/search/screen_trials.hpp"

namespace pvg::diagnose {
namespace {

using Eigen::MatrixXd, Eigen::VectorXd;

// The base model with the measured starts: those that fit it best may be far off, to make up for the missing
// effect.
Fit from_measured_starts(Fitter& fitter, const FitData& data, const Fit& base) {
  Fit measured = fitter.begin(data, {base.model}).front();
  if (!measured.succeeded) return base;
  measured.slope = base.slope;
  measured.scale = robust_scale(measured.residual);
  return measured;
}

// The actual reduction of the robust cost of some windows at each trial: laws with a dead zone or a kink differ from
// the linear prediction. The best trial becomes the candidate's model.
void try_optima(Fitter& fitter, const FitData& data, const Fit& base, double n_data, std::size_t n_tried,
                std::vector<Screened>& screened) {
  Fit few = base;
  const FitData some = some_windows(data, criteria().screen_n_windows, few);
  const std::vector<double> scales = window_scales(few.residual);
  const auto cost_of = [&](const auto& residual_of) {
    std::vector<VectorXd> left;
    for (std::size_t w = 0; w < some.windows.size(); ++w)
      left.push_back(beside_starts(some.of_start[w], residual_of(w)));
    return robust_cost(left, scales);
  };
  const double before = cost_of([&](std::size_t w) { return few.residual[w]; });
  double n_some = 0;
  for (const VectorXd& r : few.residual) n_some += double(r.size());
  const std::size_t n = std::min(n_tried, screened.size());
  std::vector<Model> models;
  std::vector<std::size_t> first = {0};  // [n + 1] of each candidate
  for (std::size_t i = 0; i < n; ++i) {
    for (Model& model : places_of(screened[i], base.model.x.size())) models.push_back(std::move(model));
    for (Model& model : places_at_shapes(fitter, some, few, screened[i])) models.push_back(std::move(model));
    first.push_back(models.size());
  }
  const auto found = fitter.evaluate(some, models, std::vector(models.size(), few.delta));
  for (std::size_t i = 0; i < n; ++i) {
    const double penalty = 0.5 * double(screened[i].candidate->parameters.size()) * std::log(n_data);
    double best = 0;
    for (std::size_t m = first[i]; m < first[i + 1]; ++m) {
      const double after = cost_of([&](std::size_t w) { return found[m][w].residual; });
      const double gain = (before - after) * n_data / n_some - penalty;
      if (!(gain > best)) continue;
      best = gain;
      screened[i].model.x = models[m].x;
    }
    screened[i].gain = best;
  }
}

// Indices of the trials that change the residuals.
std::vector<std::size_t> seen_of(std::span<const std::vector<VectorXd>> found) {
  std::vector<std::size_t> seen;
  for (std::size_t t = 0; t < found.size(); ++t)
    if (size_of(found[t]) > criteria().sensitivity_least) seen.push_back(t);
  return seen;
}

// The normal equations of `n_base` parameters of the base and of the trials in `seen`; trials in units of their
// steps.
Reduced normal_equations(const FitData& data, const Fit& base, Eigen::Index n_base, std::span<const std::size_t> seen,
                         std::span<const std::vector<VectorXd>> found) {
  Fit fit = base;
  fit.window_scale = window_scales(base.residual);
  const Eigen::Index n = n_base + Eigen::Index(seen.size());
  fit.slope.assign(data.windows.size(), {});
  for (std::size_t w = 0; w < data.windows.size(); ++w) {
    fit.slope[w].resize(base.residual[w].size(), n);
    for (Eigen::Index i = 0; i < n_base; ++i) fit.slope[w].col(i) = base.slope[w].col(i) * base.model.scale[i];
    for (std::size_t i = 0; i < seen.size(); ++i) fit.slope[w].col(n_base + Eigen::Index(i)) = found[seen[i]][w];
  }
  fit.model.x = VectorXd::Zero(n);
  return reduce(fit);
}

// The priors of the base's nuisances, which come first, in units of its scale.
void add_priors(const Model& base, MatrixXd& a, VectorXd& g) {
  const std::vector<const Parameter*> parameters = base.parameters();
  for (Eigen::Index i = 0; i < base.n_nuisances(); ++i) {
    const Parameter& p = *parameters[std::size_t(i)];
    const double weight = std::pow(base.scale[i] / p.prior_sigma, 2);
    a(i, i) += weight;
    g[i] += weight * (base.x[i] - p.off) / base.scale[i];
  }
}

// The normal equations of the trials with the base's nuisances free.
struct Beside {
  MatrixXd a;
  VectorXd g;
};
Beside beside_nuisances(const Model& base, MatrixXd a, VectorXd g) {
  const Eigen::Index n = base.n_nuisances(), m = a.rows() - n;
  if (n == 0) return {std::move(a), std::move(g)};
  add_priors(base, a, g);
  const auto factor = a.topLeftCorner(n, n).ldlt();
  const MatrixXd cross = a.topRightCorner(n, m);
  return {a.bottomRightCorner(m, m) - cross.transpose() * factor.solve(cross),
          g.tail(m) - cross.transpose() * factor.solve(g.head(n))};
}

// What noise alone would give: residuals of zero, each sample with the weight 1.
MatrixXd information_of(const FitData& data, const Fit& base, std::span<const std::size_t> seen,
                        std::span<const std::vector<VectorXd>> found) {
  Fit noise = base;
  for (VectorXd& r : noise.residual) r.setZero();
  const double weight = (criteria().student_freedom + 1) / criteria().student_freedom;
  const MatrixXd a = normal_equations(data, noise, base.model.n_nuisances(), seen, found).sum_a() / weight;
  return beside_nuisances(base.model, a, VectorXd::Zero(a.rows())).a;
}

Signatures signatures_from(const FitData& data, const Fit& base, std::span<const Trial> trials,
                           std::span<const std::vector<VectorXd>> found) {
  Signatures out;
  const std::vector<std::size_t> seen = seen_of(found.first(trials.size()));
  for (const std::size_t t : seen) {
    out.candidate.push_back(trials[t].candidate);
    out.parameter.push_back(trials[t].parameter);
    out.step.push_back(trials[t].step);
  }
  if (seen.empty()) return out;
  const Reduced reduced = normal_equations(data, base, base.model.n_nuisances(), seen, found);
  Beside beside = beside_nuisances(base.model, reduced.sum_a(), reduced.sum_g());
  out.a = std::move(beside.a);
  out.g = std::move(beside.g);
  out.information = information_of(data, base, seen, found);
  return out;
}

}  // namespace

VectorXd least_within(const MatrixXd& a, const VectorXd& g, const VectorXd& low, const VectorXd& high) {
  VectorXd x = VectorXd::Zero(g.size());
  std::vector<Eigen::Index> open(std::size_t(g.size()));
  std::iota(open.begin(), open.end(), 0);
  while (!open.empty()) {
    const VectorXd left = g + a * x;  // what is open is zero in x
    const MatrixXd inner = a(open, open);
    const VectorXd found = -inner.ldlt().solve(left(open));
    std::size_t farthest = open.size();
    double most = 0;
    for (std::size_t i = 0; i < open.size(); ++i) {
      const Eigen::Index k = open[i];
      const double f = found[Eigen::Index(i)], beyond = std::max(low[k] - f, f - high[k]) / std::max(std::abs(f), 1.0);
      if (beyond > most) most = beyond, farthest = i;
    }
    if (farthest == open.size()) {
      x(open) = found;
      break;
    }
    const Eigen::Index k = open[farthest];
    x[k] = std::clamp(found[Eigen::Index(farthest)], low[k], high[k]);
    open.erase(open.begin() + std::ptrdiff_t(farthest));
  }
  return x;
}

namespace {

// The best sum of one candidate's signatures, starts and base model free; no gain where the residuals do not change.
Screened linear_optimum(const FitData& data, const Fit& base, double n_data, std::span<const Trial> trials,
                        std::span<const std::vector<VectorXd>> found) {
  const Candidate& candidate = *trials.front().candidate;
  Screened one{&candidate, with_candidate(base.model, candidate), 0, 0};
  const Eigen::Index n_base = base.model.x.size();
  const std::vector<std::size_t> seen = seen_of(found);
  if (seen.empty()) return one;
  const Reduced reduced = normal_equations(data, base, n_base, seen, found);
  MatrixXd a = reduced.sum_a();
  VectorXd g = reduced.sum_g();
  add_priors(base.model, a, g);
  a.diagonal().array() += criteria().screen_ridge * a.trace();
  // in units of the steps
  VectorXd low(a.rows()), high(a.rows());
  const std::vector<const Parameter*> bounds = base.model.parameters();
  for (Eigen::Index i = 0; i < n_base; ++i) {
    const Parameter& p = *bounds[std::size_t(i)];
    // how far a nuisance goes its prior says
    const double most = i < base.model.n_nuisances() ? INFINITY : criteria().screen_base_steps_most;
    low[i] = std::max(-most, std::min((p.low - base.model.x[i]) / base.model.scale[i], 0.0));
    high[i] = std::min(most, std::max((p.high - base.model.x[i]) / base.model.scale[i], 0.0));
  }
  for (std::size_t i = 0; i < seen.size(); ++i) {
    const Parameter& p = candidate.parameters[trials[seen[i]].parameter];
    const double step = trials[seen[i]].step, one_end = (p.low - p.off) / step, other_end = (p.high - p.off) / step;
    low[n_base + Eigen::Index(i)] = std::max(-criteria().screen_steps_most, std::min(one_end, other_end));
    high[n_base + Eigen::Index(i)] = std::min(criteria().screen_steps_most, std::max(one_end, other_end));
  }
  const VectorXd dx = least_within(a, g, low, high);
  for (std::size_t i = 0; i < seen.size(); ++i) {
    const Trial& trial = trials[seen[i]];
    const Eigen::Index at = n_base + Eigen::Index(trial.parameter);
    one.model.x[at] = candidate.parameters[trial.parameter].off + dx[n_base + Eigen::Index(i)] * trial.step;
    one.model.scale[at] = std::abs(trial.step);
    one.sensitivity = std::max(one.sensitivity, size_of(found[seen[i]]));
  }
  one.model.x.head(n_base) += (dx.head(n_base).array() * base.model.scale.head(n_base).array()).matrix();
  one.gain = -(g.dot(dx) + 0.5 * dx.dot(a * dx)) - 0.5 * double(candidate.parameters.size()) * std::log(n_data);
  return one;
}

}  // namespace

namespace {

Changes try_changes(Fitter& fitter, const FitData& data, const Fit& base, double wanted,
                    const std::vector<const Candidate*>& candidates, const Effort& effort) {
  Changes tried;
  std::vector<std::vector<VectorXd>> known;
  const std::vector<Trial> chosen =
      choose_steps(fitter, data, base, wanted, candidates, effort.response_off_most, &known);
  for (std::size_t t = 0; t < chosen.size(); ++t) {
    if (chosen[t].step == 0) continue;
    tried.trials.push_back(chosen[t]);
    tried.found.push_back(std::move(known[t]));
  }
  tried.n_first = tried.trials.size();
  if (effort.tries_both_sides) {
    const std::vector<Trial> other_side = mirrored(tried.trials);
    tried.trials.insert(tried.trials.end(), other_side.begin(), other_side.end());
    tried.found.resize(tried.trials.size());
  }
  std::vector<Trial> open;
  for (std::size_t t = 0; t < tried.trials.size(); ++t)
    if (tried.found[t].empty()) open.push_back(tried.trials[t]);
  std::vector<std::vector<VectorXd>> found = responses(fitter, data, base, open);
  std::size_t at = 0;
  for (std::vector<VectorXd>& one : tried.found)
    if (one.empty()) one = std::move(found[at++]);
  return tried;
}

void append(Changes& all, Changes more) {
  const auto insert = [](auto& to, std::size_t at, auto& from, std::size_t begin, std::size_t end) {
    to.insert(to.begin() + std::ptrdiff_t(at), from.begin() + std::ptrdiff_t(begin),
              from.begin() + std::ptrdiff_t(end));
  };
  for (const auto& [at, begin, end] : {std::tuple(all.trials.size(), more.n_first, more.trials.size()),
                                       std::tuple(all.n_first, std::size_t(0), more.n_first)}) {
    insert(all.trials, at, more.trials, begin, end);
    insert(all.found, at, more.found, begin, end);
  }
  all.n_first += more.n_first;
}

}  // namespace

namespace {

double n_data_of(const Fit& fit) {
  double n = 0;
  for (const VectorXd& r : fit.residual) n += double(r.size());
  return n;
}

bool is_better(const Screened& a, const Screened& b) { return a.gain > b.gain; }

// Each of these candidates at its linear optimum beside the base, best first.
std::vector<Screened> linear_optima(const FitData& data, const Fit& base,
                                    const std::vector<const Candidate*>& candidates, const Changes& changes) {
  const std::vector<Trial>& trials = changes.trials;
  const double n_data = n_data_of(base);
  std::vector<Screened> screened;
  for (std::size_t first = 0, last = 0; first < trials.size(); first = last) {
    const std::size_t end = first < changes.n_first ? changes.n_first : trials.size();
    while (last < end && trials[last].candidate == trials[first].candidate) ++last;
    if (std::find(candidates.begin(), candidates.end(), trials[first].candidate) == candidates.end()) continue;
    Screened one = linear_optimum(data, base, n_data, std::span(trials).subspan(first, last - first),
                                  std::span(changes.found).subspan(first, last - first));
    if (!(one.gain > 0) && !(is_tried_anyway(*one.candidate) && one.sensitivity > 0)) continue;
    const auto before = std::find_if(screened.begin(), screened.end(),
                                     [&](const Screened& other) { return other.candidate == one.candidate; });
    if (before == screened.end())
      screened.push_back(std::move(one));
    else if (one.gain > before->gain)
      *before = std::move(one);
  }
  std::stable_sort(screened.begin(), screened.end(), is_better);
  return screened;
}

}  // namespace

ScreeningResult screen(Fitter& fitter, const FitData& data, const Fit& fitted,
                       const std::vector<const Candidate*>& candidates, Signatures* signatures, const Effort& effort) {
  ScreeningResult result;
  std::vector<Screened>& screened = result.best;
  const Fit base = from_measured_starts(fitter, data, fitted);
  // the misfit itself
  const double wanted = std::clamp(rms(fitted.residual), criteria().screen_change_least, criteria().screen_change_most);
  Changes& tried = result.changes;
  const auto try_all = [&] {
    while (result.n_screened < candidates.size()) {
      const std::size_t n = std::min(effort.at_once, candidates.size() - result.n_screened);
      const auto first = candidates.begin() + std::ptrdiff_t(result.n_screened);
      append(tried, try_changes(fitter, data, base, wanted, {first, first + std::ptrdiff_t(n)}, effort));
      result.n_screened += n;
    }
  };
  if (effort.share < 1)
    ends_by(fitter.deadline(), after_share(fitter.deadline(), effort.share), try_all);
  else
    try_all();
  if (signatures != nullptr)
    *signatures = signatures_from(data, base, std::span(tried.trials).first(tried.n_first), tried.found);
  screened = linear_optima(data, base, candidates, tried);
  if (screened.empty() || effort.n_tried == 0) return result;
  std::stable_partition(screened.begin(), screened.end(),
                        [](const Screened& s) { return is_tried_anyway(*s.candidate); });
  try_optima(fitter, data, base, n_data_of(base), effort.n_tried, screened);
  std::stable_sort(screened.begin(), screened.begin() + std::ptrdiff_t(std::min(effort.n_tried, screened.size())),
                   is_better);
  return result;
}

std::vector<Screened> screen_by_changes(const FitData& data, const Fit& fitted,
                                        const std::vector<const Candidate*>& candidates, const Changes& changes) {
  return linear_optima(data, fitted, candidates, changes);
}

bool are_in(const Changes& changes, const FitData& data) {
  return std::all_of(changes.found.begin(), changes.found.end(), [&](const std::vector<VectorXd>& found) {
    return std::equal(
        found.begin(), found.end(), data.windows.begin(), data.windows.end(),
        [](const VectorXd& r, const Window& window) { return r.size() == Eigen::Index(window.data.size()); });
  });
}

Signatures signatures_of(Fitter& fitter, const FitData& data, const Fit& fitted,
                         const std::vector<const Candidate*>& candidates) {
  const Fit base = from_measured_starts(fitter, data, fitted);
  std::vector<Trial> trials = choose_steps(
      fitter, data, base, std::clamp(rms(fitted.residual), criteria().screen_change_least, criteria().pair_change_most),
      candidates);
  std::erase_if(trials, [](const Trial& t) { return t.step == 0; });
  std::vector<std::vector<VectorXd>> found = responses(fitter, data, base, trials);
  return signatures_from(data, base, trials, found);
}

std::vector<Screened> shortlist(const std::vector<Screened>& screened, std::size_t most, std::size_t n_per_family) {
  std::vector<Screened> list;
  std::map<Family, int> n_of;
  for (std::size_t i = 0; i < screened.size(); ++i) {
    int& n = n_of[screened[i].candidate->family];
    if (i < most || std::size_t(n) < n_per_family) {
      list.push_back(screened[i]);
      ++n;
    }
  }
  return list;
}

}  // namespace pvg::diagnose
