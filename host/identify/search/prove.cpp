#include "host/identify/search/prove.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "host/identify/criteria.hpp"
#include "host/identify/fit/limits.hpp"
#include "host/identify/fit/whole_runs.hpp"

namespace pvg::diagnose {
namespace {

constexpr double UNMOVED = 1e-6;  // of its standard deviation: nothing is sensitive to it

std::vector<NamedEffect> named_of(const Fit& fit) {
  std::vector<NamedEffect> named;
  Eigen::Index at = fit.model.n_nuisances();
  for (const Candidate* part : fit.model.effects()) {
    NamedEffect effect{part, {}};
    for (const Parameter& p : part->parameters) {
      const double sigma = std::sqrt(std::max(fit.covariance(at, at), 0.0)), found = fit.model.x[at++];
      effect.parameters.push_back(named_parameter(p, std::abs(found - p.off) < UNMOVED * sigma ? p.off : found, sigma));
    }
    named.push_back(std::move(effect));
  }
  return named;
}

// What it fits besides.
Model nuisances_in(const Fit& fit) {
  const Eigen::Index n = fit.model.n_nuisances();
  return {{fit.model.parts.begin(), fit.model.parts.begin() + n}, fit.model.x.head(n), fit.model.scale.head(n)};
}

std::vector<AdjustedNumber> adjusted_of(const Fit& fit) {
  std::vector<AdjustedNumber> numbers;
  for (Eigen::Index i = 0; i < fit.model.n_nuisances(); ++i) {
    const Candidate& nuisance = *fit.model.parts[std::size_t(i)];
    const Parameter& p = nuisance.parameters[0];
    const double deviation = fit.covariance.rows() > i ? std::sqrt(std::max(fit.covariance(i, i), 0.0)) : p.prior_sigma;
    numbers.push_back({nuisance.name, nuisance.target, p.unit, p.off, p.prior_sigma, fit.model.x[i], deviation});
  }
  return numbers;
}

bool any_held_out(const Problem& problem) {
  return std::any_of(problem.runs.begin(), problem.runs.end(), [](const Run& run) { return run.is_held_out; });
}

// The named model on whole held-out runs. Where the windows are whole runs already they have shown it.
WholeRuns prove_on_whole_runs(Workflow& flow, const ChosenWindows& chosen, const HeldOut& judged, const Model& named,
                              bool in_noise) {
  WholeRuns whole;
  if (judged.floor == 0) {
    whole.why_not =
        any_held_out(flow.problem) ? "the held-out runs were not judged" : "no run was held out to prove it on";
    return whole;
  }
  if (chosen.length == 0) {
    whole.before = judged.before, whole.after = judged.after, whole.floor = judged.floor;
    return whole;
  }
  whole.why_not = "there was no time";
  whole.had_no_time = true;
  flow.ends_in_time(criteria().time_proof, "the proof on whole runs", [&] {
    whole = judge_whole_runs(flow.fitter, flow.problem, criteria().whole_run_proof, named, in_noise, judged.disturbed);
  });
  return whole;
}

// What was found in the windows of the scene as it stands, beside it. Fitted to whole runs it is simulated in these
// windows first; none where there is no time.
std::vector<Curve> fitted_curves(Workflow& flow, const ChosenWindows& chosen, const Fit& named) {
  const auto curves = [&](const Fit& shown) {
    return curves_of(flow.problem, chosen.data, chosen.base, shown, CURVES_OF_FITTED_RUNS);
  };
  if (named.residual.size() == chosen.data.windows.size()) return curves(named);
  std::vector<Curve> found;
  flow.ends_in_time(criteria().time_proof, "curves of the fitting runs", [&] {
    const FitData data = flow.fitter.prepare(chosen.data.windows, named.model);
    if (data.windows.size() == chosen.data.windows.size())
      found = curves(flow.fitter.fit(data, {named.model}, 0).front());
  });
  return found;
}

// A sentence on them; unit: of the errors.
std::string text_of(const WholeRuns& whole, const std::string& unit) {
  if (!whole.is_judged()) return "the held-out runs were judged by windows alone, not whole: " + whole.why_not;
  return fmt::format(
      "held-out runs simulated whole from their first state: error {:.3g} before and {:.3g} after, {}; "
      "errors of their starts grow to {:.2g} times the noise",
      whole.before, whole.after, unit == "noise" ? "times the noise" : unit, whole.growth);
}

// Of several effects of which the first alone closes too little, and which leave more than noise.
std::string text_of(const Lead& lead) {
  if (std::isnan(lead.sigma))
    return "the effects could not be compared with others of as many on the held-out runs, since there was no time, or "
           "no others were fitted: no name";
  return fmt::format(
      "on the held-out runs the effects are {:.1f} standard deviations ahead of the nearest other model, {}; {:g} "
      "are needed for a name",
      lead.sigma, lead.nearest, criteria().gain_sigma);
}

}  // namespace

NamedParameter named_parameter(const Parameter& p, double x, double sigma) {
  const double factor = p.is_logarithmic ? std::exp(2 * sigma / x) : 1;
  const double low = p.is_logarithmic ? x / factor : x - 2 * sigma,
               high = p.is_logarithmic ? x * factor : x + 2 * sigma;
  return {p.name, p.unit, x, std::max(low, p.low), std::min(high, p.high)};
}

bool closes_enough(const HeldOut& held_out) {
  const auto of = [&](double after) { return closed(held_out.before, after, held_out.floor); };
  const double least = criteria().gap_closed_least;
  if (!(held_out.floor > 0) || !(held_out.after < held_out.before) || of(held_out.after) < least) return false;
  if (held_out.kept < 2 || held_out.after < criteria().unexplained * held_out.floor) return true;
  for (std::size_t m = 0; m < held_out.kept; ++m)
    if (of(held_out.after_each[m]) >= share_of_effects(least, m + 1) && held_out.lead[m].sigma >= criteria().gain_sigma)
      return true;
  return false;
}

Proof prove(Workflow& flow, const ChosenWindows& chosen, Selection selected, const std::string& unit) {
  const Problem& problem = flow.problem;
  std::vector<Model> models;
  for (const Fit& fit : selected.fits) models.push_back(fit.model);
  const std::size_t most = most_windows(problem, flow.settings.simulated_seconds, chosen.length);
  HeldOut judged;
  const bool is_done = flow.ends_in_time(criteria().time_proof, "the proof on held-out runs", [&] {
    judged = judge_held_out(flow.fitter, problem, chosen.length, most, models, unit == "noise", selected.alternatives);
  });
  for (const Lead& lead : judged.lead)
    if (!std::isinf(lead.sigma)) flow.notes.push_back(text_of(lead));
  if (!is_done) judged.kept = models.size();
  const std::size_t left = std::max<std::size_t>(judged.kept, 1);
  const bool any_selected = !selected.fits.empty();
  const Fit& named = selected.fits.empty() ? chosen.base : selected.fits[left - 1];
  if (left < selected.fits.size()) {  // the others proved nothing: behind what is named they are a hint
    const auto first = selected.ranking.begin(), named_one = first + std::ptrdiff_t(selected.fits.size() - left);
    std::for_each(first, named_one, [](RankedModel& model) { model.fails_held_out = true; });
    std::rotate(first, named_one, named_one + 1);
    if (left == 1) selected.inseparable = selected.inseparable_of_one;
    selected.inseparable.resize(std::min(selected.inseparable.size(), left));
    selected.error = selected.ranking.front().error;
  }
  if (any_held_out(problem) && is_done && judged.floor == 0)
    flow.notes.push_back("the held-out runs could not be simulated to their end");
  for (const Disturbance& d : judged.disturbed) {
    char text[300];
    std::snprintf(text, sizeof text,
                  "held-out run %s, %.2f to %.2f s: wrong by %.3g times the noise before and %.3g after, which nothing "
                  "here explains (was it pushed?); left out of the held-out errors, which are %.3g and %.3g %s with it",
                  d.run.c_str(), d.start, d.end, d.before, d.after, judged.before_all, judged.after_all,
                  unit == "noise" ? "times the noise" : unit.c_str());
    flow.notes.push_back(text);
  }
  WholeRuns whole = prove_on_whole_runs(flow, chosen, judged, named.model, unit == "noise");
  if (any_held_out(problem)) flow.notes.push_back(judged.floor > 0 ? text_of(whole, unit) : whole.why_not);
  std::vector<NamedEffect> effects = named_of(named);
  std::vector<Curve> curves = std::move(judged.curves);
  const std::vector<Curve> fitted = fitted_curves(flow, chosen, named);
  curves.insert(curves.end(), fitted.begin(), fitted.end());
  return {std::move(selected), std::move(effects), adjusted_of(named), nuisances_in(named),
          std::move(judged),   std::move(whole),   std::move(curves),  any_selected && is_at_bound(named)};
}

bool is_explained(Workflow& flow, const FitData& data, const Fit& named, double length) {
  const double left = rms(named.residual);
  if (left >= criteria().unexplained) return false;
  const Agreement by_samples = agreement_of(flow.problem, data.windows, named.residual);
  if (by_samples.is_agreement) return true;
  HeldOut held_out;
  flow.ends_in_time(criteria().time_search, "whether held-out runs need another effect", [&] {
    const std::size_t most = most_windows(flow.problem, flow.settings.simulated_seconds, length);
    held_out = judge_held_out(flow.fitter, flow.problem, length, most, {named.model}, true);
  });
  if (!(held_out.after > criteria().explained_held_out * held_out.floor)) return true;
  flow.notes.push_back(
      fmt::format("{} leaves {:.3g} times the noise in the fitted runs ({}) and {:.3g} in held-out ones",
                  named.model.parts.back()->label(), left, text_of(by_samples), held_out.after));
  return false;
}

}  // namespace pvg::diagnose
