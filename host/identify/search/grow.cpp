#include <algorithm>
#include <cmath>

#include "host/identify/criteria.hpp"
#include "host/identify/search/exchange.hpp"
#include "host/identify/search/pairs.hpp"
#include "host/identify/search/rivals.hpp"
#include "host/identify/search/round.hpp"
#include "host/identify/search/screen.hpp"
#include "host/identify/search/workflow.hpp"

namespace pvg::diagnose {
namespace {

using Eigen::VectorXd;

std::vector<std::string> labels_of(const Model& model, std::size_t after) {
  std::vector<std::string> labels;
  for (std::size_t i = after; i < model.parts.size(); ++i) labels.push_back(model.parts[i]->label());
  return labels;
}

Fit best_of(Workflow& flow, const FitData& data, const Fit& base, std::vector<Model> models, const Fit& fit) {
  std::vector<Fit> fits = flow.fitter.begin(data, std::move(models));
  std::erase_if(fits, [](const Fit& other) { return !other.is_well; });
  flow.fitter.improve(data, fits, criteria().n_more_steps);
  flow.fitter.finish(data, fits);
  fits.push_back(fit);
  const Decision decision = decide(data, base, fits);
  return decision.chosen >= 0 ? *decision.ranking[std::size_t(decision.chosen)].fit : fit;
}

// An effect that was found first may only have stood in: for one that was found later, without it the fit is as good
// then; or for another of the first round, which is better beside what was found later. Beside that other one what was
// found later may in turn be another of its own round.
Fit reconsidered(Workflow& flow, const FitData& data, const Fit& base, const Fit& fit,
                 const std::vector<Fit>& first_round, const std::vector<Fit>& this_round) {
  std::vector<Model> models = exchanged(fit.model, 0, first_round);
  for (std::size_t i = 0; i + 1 < fit.model.parts.size(); ++i) models.push_back(without(fit.model, i));
  const Fit first = best_of(flow, data, base, std::move(models), fit);
  const std::vector<const Candidate*>& parts = first.model.parts;
  const auto later = std::find(parts.begin(), parts.end(), fit.model.parts.back());
  if (parts.size() < 2 || parts == fit.model.parts || later == parts.end()) return first;
  return best_of(flow, data, base, exchanged(first.model, std::size_t(later - parts.begin()), this_round), first);
}

// What a coarse time step does wrong, and how the windows answer to their starts, is another matter with the effect
// than without: both are found again there, and the fit goes on.
Fit settled(Workflow& flow, FitData& data, const Fit& fit) {
  FitData near = flow.fitter.prepare_near(data.windows, fit.model);
  if (near.windows.size() != data.windows.size()) return fit;
  Fit better = flow.fitter.fit(near, {fit.model}, criteria().n_more_steps).front();
  if (!better.is_well || robust_cost(better.residual, fit.scale) > robust_cost(fit.residual, fit.scale)) return fit;
  data = std::move(near);
  return better;
}

}  // namespace

RankedModel ranked(const Judged& judged) {
  RankedModel model{judged.fit->model.parts, judged.error, judged.evidence, judged.probability, {}};
  for (const double x : judged.fit->model.x) model.values.push_back(x);
  return model;
}

std::vector<Fit> grow(Workflow& flow, FitData data, const Fit& base) {
  Diagnosis& out = flow.out;
  const FitData as_it_stands = data;
  std::vector<Fit> grown, first_round, tried;  // tried: single ones beside which a second was looked for
  double least_of_one = INFINITY;              // left-out error, of those that pass in the first round
  double of_round = 0;                         // how long the last one took [s]
  Fit named = base;
  // one round more than effects, for one that took another's place
  for (int number = 1; number <= flow.settings.max_effects + (flow.settings.max_effects > 1); ++number) {
    if (int(named.model.parts.size()) >= flow.settings.max_effects) break;
    if (number > 1 && !flow.has_time("an effect beside " + named.model.parts.back()->label(), of_round)) return grown;
    const double since = flow.seconds();
    if (named.model.parts.size() == 1) tried.push_back(named);
    const Round round = run_round(flow, data, named, std::to_string(number), number == 1 ? 0.4 : 0.75);
    of_round = flow.seconds() - since;
    const Decision& decision = round.decision;
    if (number == 1)
      for (const Judged& judged : decision.ranking) out.ranking.push_back(ranked(judged));
    if (decision.chosen < 0) break;
    const Judged& chosen = decision.ranking[std::size_t(decision.chosen)];
    // beside an effect whose law is not quite right a second one helps, as another single one may as well
    if (number > 1 &&
        closed(std::min(decision.base_error, least_of_one), chosen.error, 1) < criteria().second_gain_least)
      break;
    if (number > 1)
      out.ranking.insert(out.ranking.begin(), ranked(chosen));
    else
      std::rotate(out.ranking.begin(), out.ranking.begin() + decision.chosen,
                  out.ranking.begin() + decision.chosen + 1);
    std::vector<std::string> set;
    for (const std::size_t i : decision.inseparable) {
      const std::vector<std::string> labels = labels_of(decision.ranking[i].fit->model, named.model.parts.size());
      set.insert(set.end(), labels.begin(), labels.end());
    }
    if (!set.empty()) out.inseparable.push_back(set);
    if (!decision.inseparable.empty() && out.next_experiment.empty())
      out.next_experiment = chosen.fit->model.parts.back()->experiment;
    const std::size_t n_parts = chosen.fit->model.parts.size();
    std::vector<Fit> passed;  // best first
    for (const Judged& judged : decision.ranking)
      if (judged.passes) passed.push_back(*judged.fit);
    if (number == 1) {
      first_round = passed;
      for (const Judged& judged : decision.ranking)
        if (judged.passes) least_of_one = std::min(least_of_one, judged.error);
    }
    named = n_parts > 1 && flow.settings.decide == Decide::workflow
                ? reconsidered(flow, data, base, *chosen.fit, first_round, passed)
                : *chosen.fit;
    if (flow.settings.decide == Decide::workflow) named = settled(flow, data, named);
    const double error = rms(named.residual);
    if (named.model.parts != chosen.fit->model.parts)
      out.ranking.front() = {
          named.model.parts, error, chosen.evidence, chosen.probability, {named.model.x.begin(), named.model.x.end()}};
    if (named.model.parts.size() < n_parts) {  // what remains stands alone
      grown.clear();
      out.inseparable.clear();
    }
    grown.push_back(named);
    out.fit_after = error;
    if (error < criteria().unexplained) break;
    if (int(named.model.parts.size()) < flow.settings.max_effects)
      flow.tell(4, 0.6,
                "what " + named.model.parts.back()->label() + " leaves is " + std::to_string(error) +
                    " times the noise: looking for another effect");
  }
  const bool is_explained = !grown.empty() && rms(named.residual) < criteria().unexplained;
  if (is_explained || flow.settings.max_effects < 2 || flow.settings.decide != Decide::workflow) return grown;
  if (const std::optional<Fit> pair =
          find_beside_rivals(flow, as_it_stands, first_round, tried, criteria().unexplained, of_round)) {
    grown = {settled(flow, data, *pair)};
    out.fit_after = rms(grown.back().residual);
    return grown;
  }
  if (!flow.has_time("a pair of effects", of_round)) return grown;
  if (const std::optional<Fit> pair = find_pair(flow, data, base, criteria().unexplained)) {
    grown = {settled(flow, data, *pair)};
    out.fit_after = rms(grown.back().residual);
  }
  return grown;
}

}  // namespace pvg::diagnose
