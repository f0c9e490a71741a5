#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "host/identify/criteria.hpp"
#include "host/identify/fit/on_whole_runs.hpp"
#include "host/identify/fit/prepared.hpp"
#include "host/identify/search/alternatives.hpp"
#include "host/identify/search/finer_steps.hpp"
#include "host/identify/search/pairs.hpp"
#include "host/identify/search/round.hpp"
#include "host/identify/search/screen.hpp"
#include "host/identify/search/swap.hpp"
#include "host/identify/search/workflow.hpp"

namespace pvg::diagnose {
namespace {

using Eigen::VectorXd;

// Of the effects that `before` does not have.
std::vector<std::string> labels_of(const Model& model, const Model& before = {}) {
  std::vector<std::string> labels;
  for (const Candidate* part : model.effects())
    if (std::find(before.parts.begin(), before.parts.end(), part) == before.parts.end())
      labels.push_back(part->label());
  return labels;
}

bool begins_with(const std::vector<const Candidate*>& all, const std::vector<const Candidate*>& first) {
  return first.size() <= all.size() && std::equal(first.begin(), first.end(), all.begin());
}

Fit best_of(Workflow& flow, Prepared& prepared, std::vector<Model> models, const Fit& fit) {
  const FitData& data = prepared.data();
  std::vector<Fit> fits = flow.fitter.begin(data, std::move(models));
  std::erase_if(fits, [](const Fit& other) { return !other.succeeded; });
  flow.fitter.improve(data, fits, criteria().n_more_steps);
  flow.fitter.finish(data, fits);
  fits.push_back(fit);
  const Decision decision = decide(data, prepared.base(flow.fitter), fits);
  return decision.chosen >= 0 ? *decision.ranking[std::size_t(decision.chosen)].fit : fit;
}

// Backward check: drop an effect if the model without it fits equally well from where the others are now. The newest is
// dropped too: the earlier ones may have been short of their optimum, or in windows that were prepared for the scene
// without them, and a second effect makes up for that. Swap: replace the first by another effect of the first round if
// that is better beside the later one; beside that alternative the later effect may be swapped for one of its own
// round.
Fit reconsidered(Workflow& flow, Prepared& prepared, const Fit& fit, const std::vector<Fit>& first_round,
                 const std::vector<Fit>& this_round) {
  const std::size_t n_nuisances = std::size_t(fit.model.n_nuisances());
  std::vector<Model> models = swapped(fit.model, n_nuisances, first_round);
  for (Model& simpler : each_left_out(fit.model)) models.push_back(std::move(simpler));
  const Fit first = best_of(flow, prepared, std::move(models), fit);
  const std::vector<const Candidate*>& parts = first.model.parts;
  const auto later = std::find(parts.begin(), parts.end(), fit.model.parts.back());
  if (first.model.effects().size() < 2 || parts == fit.model.parts || later == parts.end()) return first;
  return best_of(flow, prepared, swapped(first.model, std::size_t(later - parts.begin()), this_round), first);
}

// The left-out error of another single effect in the present preparation: infinite where it fails there.
double error_of_single(Workflow& flow, Prepared& prepared, const Model& model) {
  std::vector<Fit> fits = flow.fitter.begin(prepared.data(), {model});
  flow.fitter.improve(prepared.data(), fits, criteria().n_more_steps);
  flow.fitter.finish(prepared.data(), fits);
  const Decision decision = decide(prepared.data(), prepared.base(flow.fitter), fits);
  return decision.ranking.empty() ? INFINITY : decision.ranking.front().error;
}

}  // namespace

namespace {
RankedModel ranked(const Fit& fit, double error, double evidence, double probability) {
  RankedModel model{fit.model.effects(), error, evidence, probability, {}, {}};
  for (Eigen::Index i = fit.model.n_nuisances(); i < fit.model.x.size(); ++i) {
    model.values.push_back(fit.model.x[i]);
    const bool is_known = i < fit.covariance.rows();
    model.deviations.push_back(is_known ? std::sqrt(std::max(fit.covariance(i, i), 0.0)) : NAN);
  }
  return model;
}
}  // namespace

RankedModel ranked(const Judged& judged) {
  return ranked(*judged.fit, judged.error, judged.evidence, judged.probability);
}

namespace {

// Candidates that mimic what was chosen in these runs: no fit of theirs was found worse. One that was given up for want
// of a place among the finalists was not; one that was far behind was.
std::vector<std::string> told_together(const Round& round, const Judged& chosen) {
  const Model& model = chosen.fit->model;
  std::vector<std::string> labels;
  for (const Candidate* other : look_alikes(round.signatures, *model.parts.back(),
                                            model.x.tail(Eigen::Index(model.parts.back()->parameters.size())))) {
    const bool was_fitted = std::any_of(round.fits.begin(), round.fits.end(), [&](const Fit& fit) {
      return fit.succeeded && (!fit.is_given_up || fit.is_far_behind) && fit.model.parts.back() == other;
    });
    if (!was_fitted) labels.push_back(other->label());
  }
  return labels;
}

// From here on what was found is measured, and what else there is looked for, in whole runs, where it can be. Whether
// it can.
bool go_to_whole_runs(Workflow& flow, Prepared& prepared, Fit& named) {
  std::optional<OnWholeRuns> whole = on_whole_runs(flow.fitter, flow.problem, flow.settings.simulated_seconds, named);
  if (!whole) return false;
  flow.notes.push_back(
      fmt::format("{}: {:.3g} times the noise is left in short windows, {:.3g} times in whole runs, which "
                  "are the windows from here on",
                  labels_of(named.model).back(), rms(named.residual), rms(whole->fit.residual)));
  prepared = Prepared(std::move(whole->data));
  named = std::move(whole->fit);
  return true;
}

// `out` is whole after each effect: the time may be over in the search for the next one.
void select(Workflow& flow, const std::vector<Candidate>& candidates, const ChosenWindows& windows, Selection& out) {
  const FitData& data = windows.data;
  const Fit& base = windows.base;
  Prepared prepared(data, base);
  std::vector<Fit> first_round, tried;  // tried: single ones beside which a second was looked for
  std::optional<Model> best_single;     // least left-out error of those that pass in the first round
  double of_round = 0;                  // how long the last one took [s]
  bool is_of_whole_runs = false;
  Fit named = base, of_windows = base;  // of_windows: before whole runs took their place
  // one round more than effects, since a swap takes one
  for (int number = 1; number <= flow.settings.max_effects + (flow.settings.max_effects > 1); ++number) {
    if (int(named.model.effects().size()) >= flow.settings.max_effects) break;
    if (number > 1 && !flow.has_time("an effect beside " + named.model.parts.back()->label(), of_round)) return;
    const double since = flow.seconds();
    if (named.model.effects().size() == 1) tried.push_back(of_windows);
    const Round round =
        run_round(flow, candidates, prepared.data(), named, std::to_string(number), number == 1 ? 0.4 : 0.75);
    of_round = flow.seconds() - since;
    const Decision& decision = round.decision;
    if (number == 1)
      for (const Judged& judged : decision.ranking) out.ranking.push_back(ranked(judged));
    if (decision.chosen < 0) break;
    const Judged& chosen = decision.ranking[std::size_t(decision.chosen)];
    // a second effect also helps where the law of the first is not quite right; another single effect may help as much
    if (number > 1) {
      const bool is_another = best_single && best_single->parts != named.model.parts;
      const double of_another = is_another ? error_of_single(flow, prepared, *best_single) : INFINITY;
      if (closed(std::min(decision.base_error, of_another), chosen.error, 1) < criteria().second_gain_least) break;
    }
    if (number == 1)
      std::rotate(out.ranking.begin(), out.ranking.begin() + decision.chosen,
                  out.ranking.begin() + decision.chosen + 1);
    std::vector<std::string> set;
    for (const std::size_t i : decision.inseparable) {
      const std::vector<std::string> labels = labels_of(decision.ranking[i].fit->model, named.model);
      set.insert(set.end(), labels.begin(), labels.end());
    }
    if (number == 1 && flow.settings.decide == Decide::workflow)
      for (const std::string& label : told_together(round, chosen))
        if (std::find(set.begin(), set.end(), label) == set.end()) {
          if (set.empty()) set.push_back(chosen.fit->model.parts.back()->label());
          set.push_back(label);
        }
    const std::size_t n_effects = chosen.fit->model.effects().size();
    std::vector<Fit> passed;  // best first
    for (const Judged& judged : decision.ranking)
      if (judged.passes) passed.push_back(*judged.fit);
    if (number == 1) {
      first_round = passed;
      if (!passed.empty()) best_single = passed.front().model;
    }
    const Fit before = std::exchange(named, *chosen.fit);
    if (flow.settings.decide == Decide::workflow && flow.refine_step(named.model)) {
      out = Selection();
      out.asks_for_new_step = true;
      return;
    }
    if (flow.settings.decide == Decide::workflow)
      flow.ends_in_time(criteria().time_search, "the revision of " + labels_of(named.model).back(), [&] {
        if (n_effects > 1) named = reconsidered(flow, prepared, *chosen.fit, first_round, passed);
        named = prepared_again(flow.fitter, prepared, named);
      });
    const Fit& as_it_stands = is_of_whole_runs ? prepared.base(flow.fitter) : base;
    if (robust_cost(named.residual, named.scale) > robust_cost(as_it_stands.residual, named.scale)) {
      flow.notes.push_back(
          chosen.fit->model.parts.back()->label() +
          " leaves more, once starts and steps are those of it, than the scene as it stands: not taken");
      named = before;
      break;
    }
    if (!is_of_whole_runs) of_windows = named;
    if (windows.length > 0 && !is_of_whole_runs && flow.settings.decide == Decide::workflow)
      flow.ends_in_time(criteria().time_search, labels_of(named.model).back() + " on whole runs",
                        [&] { is_of_whole_runs = go_to_whole_runs(flow, prepared, named); });
    const double error = rms(named.residual);
    const bool any_dropped = named.model.effects().size() < n_effects;
    const bool is_newest_dropped = any_dropped && begins_with(chosen.fit->model.effects(), named.model.effects());
    if (is_newest_dropped)
      std::erase_if(out.ranking, [&](const RankedModel& model) { return model.parts == named.model.effects(); });
    if (number > 1)
      out.ranking.insert(out.ranking.begin(), named.model.parts == chosen.fit->model.parts
                                                  ? ranked(chosen)
                                                  : ranked(named, error, chosen.evidence, chosen.probability));
    if (is_newest_dropped) {  // the same effects as before, at a better optimum
      out.fits.pop_back();
    } else {
      if (!set.empty()) out.inseparable.push_back(set);
      if (any_dropped) {  // the first effect was
        out.fits.clear();
        out.inseparable.clear();
      }
    }
    out.fits.push_back(named);
    out.windows = prepared.data().windows;
    out.error = error;
    out.better_at_bound.clear();
    if (decision.better_at_bound >= 0 && flow.settings.decide == Decide::workflow)
      out.better_at_bound = labels_of(decision.ranking[std::size_t(decision.better_at_bound)].fit->model).back();
    if (error < criteria().unexplained || is_newest_dropped) break;
    if (int(named.model.effects().size()) < flow.settings.max_effects)
      flow.report_progress(4, 0.6,
                           "what " + named.model.parts.back()->label() + " leaves is " + std::to_string(error) +
                               " times the noise: looking for another effect");
  }
  // short windows that one effect explains tell nothing of pairs
  const double left = std::min(rms(named.residual), rms(of_windows.residual));
  const bool is_explained = !out.fits.empty() && left < criteria().unexplained;
  if (is_explained || flow.settings.max_effects < 2 || flow.settings.decide != Decide::workflow) return;
  const auto take = [&](const FoundPair& pair) {
    Prepared first(data, base);
    Fit fit = pair.fit;
    flow.ends_in_time(criteria().time_search, "the revision of a pair",
                      [&] { fit = prepared_again(flow.fitter, first, fit); });
    out.fits = {std::move(fit)};
    out.windows = first.data().windows;
    out.better_at_bound.clear();
    out.error = rms(out.fits.back().residual);
    out.ranking.insert(out.ranking.begin(), pair.model);
    if (!pair.inseparable.empty()) out.inseparable.push_back(pair.inseparable);
  };
  if (const std::optional<FoundPair> pair = find_beside_alternatives(flow, candidates, data, base, first_round, tried,
                                                                     criteria().unexplained, of_round)) {
    out.inseparable.resize(std::min<std::size_t>(out.inseparable.size(), 1));  // of the first effect
    take(*pair);
    return;
  }
  if (!flow.has_time("a pair of effects", of_round)) return;
  if (const std::optional<FoundPair> pair = find_pair(flow, candidates, data, base, criteria().unexplained)) {
    out.inseparable.clear();
    take(*pair);
  }
}

}  // namespace

Selection forward_selection(Workflow& flow, const std::vector<Candidate>& candidates, const ChosenWindows& chosen) {
  Selection out;
  out.error = rms(chosen.base.residual);
  flow.ends_in_time(criteria().time_search, "the rest of the search for effects",
                    [&] { select(flow, candidates, chosen, out); });
  if (out.fits.empty() || flow.settings.decide != Decide::workflow) return out;
  use_finer_steps(flow, out);
  const Fit& found = out.fits.back();
  for (RankedModel& model : out.ranking)
    if (model.parts == found.model.effects()) model = ranked(found, model.error, model.evidence, model.probability);
  return out;
}

}  // namespace pvg::diagnose
