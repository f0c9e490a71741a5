#include "host/identify/search/decide.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "host/identify/criteria.hpp"
#include "host/identify/fit/correlation.hpp"
#include "host/identify/fit/normal_equations.hpp"
#include "host/identify/fit/prior.hpp"

namespace pvg::diagnose {
namespace {

using Eigen::MatrixXd, Eigen::VectorXd;
// a wrong number of the scene is more common than a sensor's error or a missing effect
double family_log_prior(Family family) {
  const Criteria& c = criteria();
  return family == Family::physical    ? c.log_prior_physical
         : family == Family::parameter ? c.log_prior_parameter
                                       : c.log_prior_measurement;
}

// windows -> groups that are left out together
std::vector<std::size_t> groups_of(const FitData& data) {
  std::map<int, std::size_t> runs;
  for (const Window& window : data.windows) runs.emplace(window.run, runs.size());
  std::vector<std::size_t> group;
  const std::size_t n = data.windows.size();
  for (std::size_t w = 0; w < n; ++w)
    group.push_back(runs.size() >= criteria().n_runs_as_groups ? runs.at(data.windows[w].run) % criteria().n_groups_most
                                                               : w * std::min(n, criteria().n_groups_most) / n);
  return group;
}

// Residuals of each window by the fit without its group.
std::vector<VectorXd> left_out(const Fit& fit, const std::vector<std::size_t>& group) {
  const std::size_t n_groups = 1 + *std::max_element(group.begin(), group.end());
  if (fit.model.x.size() == 0 || n_groups < 2) return fit.residual;
  const Reduced reduced = reduce(fit);
  std::vector<VectorXd> residual = fit.residual;
  for (std::size_t k = 0; k < n_groups; ++k) {
    MatrixXd a = MatrixXd::Zero(fit.model.x.size(), fit.model.x.size());
    VectorXd g = VectorXd::Zero(fit.model.x.size());
    for (std::size_t w = 0; w < group.size(); ++w)
      if (group[w] != k) a += reduced.a[w], g += reduced.g[w];
    for (Eigen::Index i = 0; i < fit.model.n_nuisances(); ++i) {
      const Parameter& p = *fit.model.parameters()[std::size_t(i)];
      a(i, i) += 1 / (p.prior_sigma * p.prior_sigma);
      g[i] += (fit.model.x[i] - p.off) / (p.prior_sigma * p.prior_sigma);
    }
    // numbers, and sums of them, to which the others are not sensitive stay where they are
    a += criteria().left_out_ridge * reduced.sum_a();
    add_to_diagonal(a, 0);
    VectorXd dx = -a.ldlt().solve(g);
    for (Eigen::Index i = 0; i < dx.size(); ++i) {
      const Parameter& p = *fit.model.parameters()[std::size_t(i)];
      dx[i] = std::clamp(fit.model.x[i] + dx[i], p.low, p.high) - fit.model.x[i];
    }
    for (std::size_t w = 0; w < group.size(); ++w) {
      if (group[w] != k) continue;
      residual[w] += fit.slope[w] * dx;
      const VectorXd start = best_start(fit, w, dx);
      if (start.size() > 0) residual[w] += fit.of_start[w] * start;
    }
  }
  return residual;
}

// Log prior of the candidates and of the parameters' sizes.
double log_prior_of(const Fit& fit) {
  double log_prior = 0;
  for (const Candidate* part : fit.model.effects()) log_prior += part->log_prior + family_log_prior(part->family);
  const std::vector<const Parameter*> parameters = fit.model.parameters();
  for (std::size_t i = 0; i < parameters.size(); ++i)
    if (parameters[i]->prior_sigma > 0) log_prior -= prior_cost(*parameters[i], fit.model.x[Eigen::Index(i)]);
  return log_prior;
}

struct GroupErrors {
  std::vector<double> sum, n;  // per group: of squares, cut
  double mean() const {
    double s = 0, m = 0;
    for (std::size_t k = 0; k < sum.size(); ++k) s += sum[k], m += n[k];
    return m > 0 ? s / m : 0;
  }
};

GroupErrors errors_of(const std::vector<VectorXd>& residual, const std::vector<std::size_t>& group, double cut) {
  GroupErrors errors;
  const std::size_t n = 1 + *std::max_element(group.begin(), group.end());
  errors.sum.assign(n, 0);
  errors.n.assign(n, 0);
  for (std::size_t w = 0; w < group.size(); ++w) {
    errors.sum[group[w]] += residual[w].array().square().min(cut * cut).sum();
    errors.n[group[w]] += double(residual[w].size());
  }
  return errors;
}

// How much larger a's errors are than b's. relative: mean over the groups of (a - b) / max(a, b), so that a run with
// large errors does not count for all; relative_sigma: its standard error from the groups' scatter; against: that of
// the groups in which b is worse alone, since an effect that shows in one run only is no less an effect. noise: the
// standard error of mean(a) - mean(b) under noise of scale s for two predictions that differ, `correlated` samples
// counting as one; residuals that are cut add no noise.
struct Difference {
  double absolute = 0, noise = 0, relative = 0, relative_sigma = 0, against = 0;
  bool is_gain(double n_sigma) const {
    return absolute > n_sigma * noise && relative > std::max(n_sigma * against, criteria().relative_gain_least);
  }
  bool is_more_than(double n_sigma) const {
    return absolute > n_sigma * noise && relative > std::max(n_sigma * relative_sigma, criteria().relative_gain_least);
  }
};

Difference difference(const GroupErrors& a, const GroupErrors& b, const std::vector<VectorXd>& ra,
                      const std::vector<VectorXd>& rb, double s, double cut, double correlated) {
  double n = 0, apart = 0;
  for (std::size_t w = 0; w < ra.size(); ++w) {
    n += double(ra[w].size());
    apart += (ra[w].cwiseMax(-cut).cwiseMin(cut) - rb[w].cwiseMax(-cut).cwiseMin(cut)).squaredNorm();
  }
  Difference d;
  d.absolute = a.mean() - b.mean();
  d.noise = 2 * s * std::sqrt(correlated * apart) / std::max(n, 1.0);
  std::vector<double> of;
  for (std::size_t k = 0; k < a.sum.size(); ++k)
    if (a.n[k] > 0) of.push_back((a.sum[k] - b.sum[k]) / std::max({a.sum[k], b.sum[k], 1e-300}));
  for (const double x : of) d.relative += x / double(of.size());
  for (const double x : of) d.against = std::hypot(d.against, std::min(x, 0.0) / double(of.size()));
  for (const double x : of) d.relative_sigma += (x - d.relative) * (x - d.relative);
  if (of.size() > 1) d.relative_sigma = std::sqrt(d.relative_sigma / double(of.size() * (of.size() - 1)));
  return d;
}

// Whether any parameter that the base does not have is away from "off".
bool excludes_off(const Fit& fit, const Model& base) {
  bool any = false;
  Eigen::Index at = 0;
  for (const Candidate* part : fit.model.parts) {
    const bool is_new = std::find(base.parts.begin(), base.parts.end(), part) == base.parts.end();
    for (const Parameter& p : part->parameters) {
      const double away = std::abs(fit.model.x[at] - p.off);
      any = any || (is_new && away > criteria().gain_sigma * std::sqrt(std::max(fit.covariance(at, at), 0.0)));
      ++at;
    }
  }
  return any;
}

// Nuisances are no sign of a model that is less simple.
Eigen::Index n_parameters(const Model& model) { return model.x.size() - model.n_nuisances(); }

}  // namespace

bool is_at_bound(const Fit& fit) {
  const std::vector<const Parameter*> parameters = fit.model.parameters();
  for (std::size_t i = std::size_t(fit.model.n_nuisances()); i < parameters.size(); ++i) {
    const Parameter& p = *parameters[i];
    const double x = fit.model.x[Eigen::Index(i)], near = criteria().bound_width * (p.high - p.low);
    const double low = p.is_logarithmic ? p.low * (1 + criteria().bound_width_logarithmic) : p.low + near;
    const double high = p.is_logarithmic ? p.high / (1 + criteria().bound_width_logarithmic) : p.high - near;
    if ((x < low && std::abs(p.low - p.off) > near) || (x > high && std::abs(p.high - p.off) > near)) return true;
  }
  return false;
}

Decision decide_lowest(const Fit& base, const std::vector<Fit>& fits) {
  Decision decision;
  decision.base_error = rms(base.residual);
  for (const Fit& fit : fits) {
    Judged judged{&fit};
    judged.error = rms(fit.residual);
    judged.better_by = decision.base_error * decision.base_error - judged.error * judged.error;
    judged.excludes_off = judged.passes = judged.better_by > 0;
    decision.ranking.push_back(judged);
  }
  std::stable_sort(decision.ranking.begin(), decision.ranking.end(),
                   [](const Judged& a, const Judged& b) { return a.error < b.error; });
  if (!decision.ranking.empty() && decision.ranking[0].passes) decision.chosen = 0;
  return decision;
}

namespace {

// A fit as it is judged.
struct Entry {
  Judged judged;
  GroupErrors errors;
  std::vector<VectorXd> residual;  // left-out, of each window
  bool gains = false;              // closes more of the gap than noise would
};

// What the fits of a round are compared by.
class Comparison {
 public:
  Comparison(const FitData& data, const Fit& base, const std::vector<Fit>& fits)
      : base_(base), group_(groups_of(data)), scale_(base.scale) {
    for (const Fit& fit : fits)
      if (fit.succeeded) scale_ = std::min(scale_, fit.scale);
    base_residual_ = left_out(base, group_);
    cut_ = criteria().residual_cut * std::max(scale_, base.scale);
    base_errors_ = errors_of(base_residual_, group_, cut_);
    const Fit* closest = &base;
    for (const Fit& fit : fits)
      if (fit.succeeded && robust_cost(fit.residual, scale_) < robust_cost(closest->residual, scale_)) closest = &fit;
    correlated_ = correlation_length(data.windows, closest->residual);
    for (const VectorXd& r : base.residual) n_data_ += double(r.size());
  }

  const GroupErrors& base_errors() const { return base_errors_; }

  // The fits that succeeded, smallest left-out error first, each with its probability beside the others.
  std::vector<Entry> judge(const std::vector<Fit>& fits) const {
    std::vector<Entry> entries;
    for (const Fit& fit : fits)
      if (fit.succeeded) entries.push_back(entry_of(fit));
    std::stable_sort(entries.begin(), entries.end(),
                     [](const Entry& a, const Entry& b) { return a.judged.error < b.judged.error; });
    const double best = std::accumulate(entries.begin(), entries.end(), -1e300,
                                        [](double most, const Entry& e) { return std::max(most, e.judged.evidence); });
    double sum = 0;
    for (Entry& e : entries) sum += e.judged.probability = std::exp(e.judged.evidence - best);
    for (Entry& e : entries) e.judged.probability /= sum;
    return entries;
  }

  // The simplest that passes within one standard error of the best that passes; -1: none passes.
  int simplest_of_the_best(const std::vector<Entry>& entries) const {
    int best = -1;
    for (std::size_t i = 0; i < entries.size() && best < 0; ++i)
      if (entries[i].judged.passes) best = int(i);
    int chosen = best;
    // with one group nothing is left out, and the scatter between groups is not known
    const double near =
        *std::max_element(group_.begin(), group_.end()) == 0 ? criteria().gain_sigma : criteria().as_good_sigma;
    for (std::size_t i = 0; best >= 0 && i < entries.size(); ++i) {
      const Judged &now = entries[std::size_t(chosen)].judged, &other = entries[i].judged;
      if (!other.passes || !is_as_good(entries[i], entries[std::size_t(best)], near) ||
          other.evidence < entries[std::size_t(best)].judged.evidence - criteria().evidence_margin)
        continue;
      const Eigen::Index p = n_parameters(other.fit->model), q = n_parameters(now.fit->model);
      const double log_prior_gain = log_prior_of(*other.fit) - log_prior_of(*now.fit);
      const bool has_more_evidence = other.evidence > now.evidence;
      if ((p < q && log_prior_gain > -criteria().log_prior_margin_simpler) || (p == q && has_more_evidence) ||
          (p > q && log_prior_gain > criteria().log_prior_margin_simpler && has_more_evidence))
        chosen = int(i);
    }
    return chosen;
  }

  // Decision::inseparable
  std::vector<std::size_t> inseparable_from(const std::vector<Entry>& entries, int chosen) const {
    const Entry& named = entries[std::size_t(chosen)];
    std::vector<std::size_t> inseparable;
    for (std::size_t i = 0; i < entries.size(); ++i)
      if (entries[i].judged.passes && entries[i].judged.evidence > named.judged.evidence - criteria().evidence_margin &&
          is_as_good(entries[i], named, criteria().gain_sigma))
        inseparable.push_back(i);
    if (inseparable.size() < 2) inseparable.clear();
    return inseparable;
  }

  // Decision::better_at_bound
  int better_at_bound(const std::vector<Entry>& entries, int chosen) const {
    const Entry& named = entries[std::size_t(chosen)];
    int better = -1;
    for (std::size_t i = 0; i < entries.size(); ++i) {
      const Judged& other = entries[i].judged;
      if (entries[i].gains && !other.passes && other.evidence > named.judged.evidence &&
          n_parameters(other.fit->model) <= n_parameters(named.judged.fit->model) &&
          is_as_good(entries[i], named, criteria().gain_sigma))
        better = int(i);
    }
    return better;
  }

 private:
  Entry entry_of(const Fit& fit) const {
    Entry entry{{&fit}, {}, left_out(fit, group_)};
    entry.errors = errors_of(entry.residual, group_, cut_);
    Judged& judged = entry.judged;
    judged.error = std::sqrt(entry.errors.mean());
    judged.better_by = base_errors_.mean() - entry.errors.mean();
    const Difference better =
        difference(base_errors_, entry.errors, base_residual_, entry.residual, scale_, cut_, correlated_);
    judged.better_sigma = better.noise;
    double squares = 0;
    for (const VectorXd& r : fit.residual) squares += r.array().square().min(cut_ * cut_).sum();
    judged.evidence = -0.5 * squares / (scale_ * scale_ * correlated_) -
                      0.5 * double(n_parameters(fit.model)) * std::log(std::max(n_data_ / correlated_, 2.0)) +
                      log_prior_of(fit);
    judged.excludes_off = excludes_off(fit, base_.model);
    entry.gains = judged.excludes_off && better.is_gain(criteria().gain_sigma);
    judged.passes = entry.gains && !is_at_bound(fit);
    return entry;
  }

  bool is_as_good(const Entry& a, const Entry& than, double n_sigma) const {
    return !difference(a.errors, than.errors, a.residual, than.residual, scale_, cut_, correlated_)
                .is_more_than(n_sigma);
  }

  const Fit& base_;
  std::vector<std::size_t> group_;       // of each window: what is left out together
  std::vector<VectorXd> base_residual_;  // left-out
  GroupErrors base_errors_;
  double scale_;           // least of the base's and of the fits' [noise]
  double cut_ = 0;         // size at which residuals are cut [noise]
  double correlated_ = 1;  // samples that count as one
  double n_data_ = 0;
};

// Where the best model leaves much unexplained, its lead may come from another effect that it imitates: the log prior
// comes first among all models that close nearly as much. chosen: without that
int most_plausible(const std::vector<Entry>& entries, double base_error, int chosen) {
  const auto best = std::find_if(entries.begin(), entries.end(), [](const Entry& e) { return e.judged.passes; });
  if (!(best->judged.error > criteria().unexplained)) return chosen;
  const double most = base_error - best->judged.error;
  for (std::size_t i = 0; i < entries.size(); ++i) {
    const Judged &now = entries[std::size_t(chosen)].judged, &other = entries[i].judged;
    if (other.passes && base_error - other.error > criteria().nearly_as_much * most &&
        log_prior_of(*other.fit) > log_prior_of(*now.fit) + criteria().log_prior_margin)
      chosen = int(i);
  }
  return chosen;
}

}  // namespace

Decision decide(const FitData& data, const Fit& base, const std::vector<Fit>& fits) {
  const Comparison comparison(data, base, fits);
  Decision decision;
  decision.base_error = std::sqrt(comparison.base_errors().mean());
  const std::vector<Entry> entries = comparison.judge(fits);
  decision.chosen = comparison.simplest_of_the_best(entries);
  if (decision.chosen >= 0) {
    decision.chosen = most_plausible(entries, decision.base_error, decision.chosen);
    decision.inseparable = comparison.inseparable_from(entries, decision.chosen);
    decision.better_at_bound = comparison.better_at_bound(entries, decision.chosen);
  }
  for (const Entry& e : entries) decision.ranking.push_back(e.judged);
  return decision;
}

}  // namespace pvg::diagnose
