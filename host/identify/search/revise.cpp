#include "host/identify/search/revise.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "host/identify/criteria.hpp"
#include "host/identify/fit/swap.hpp"
#include "host/identify/search/decide.hpp"
#include "host/identify/search/round.hpp"

namespace pvg::diagnose {
namespace {

using Eigen::VectorXd;

// Those models that a step of their fit brings nearest to the data, best first.
std::vector<Model> nearest(Workflow& flow, const FitData& data, std::vector<Model> models, std::size_t most) {
  if (models.empty() || most == 0) return {};
  std::vector<Fit> fits = flow.fitter.begin(data, std::move(models));
  std::erase_if(fits, [](const Fit& fit) { return !fit.succeeded; });
  const auto after_a_step = flow.fitter.predicted(data, fits);
  double scale = std::numeric_limits<double>::infinity();
  for (const Fit& fit : fits) scale = std::min(scale, robust_scale(fit.residual));
  std::vector<double> cost;
  for (std::size_t i = 0; i < fits.size(); ++i)
    cost.push_back(std::min(robust_cost(fits[i].residual, scale), robust_cost(after_a_step[i], scale)));
  std::vector<std::size_t> order(fits.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return cost[a] < cost[b]; });
  std::vector<Model> best;
  for (std::size_t i = 0; i < std::min(most, order.size()); ++i) best.push_back(std::move(fits[order[i]].model));
  return best;
}

// The model with its effect at `place` replaced.
std::vector<Model> with_stand_ins(Workflow& flow, const FitData& data, const Model& model, std::size_t place,
                                  const StandIns& stand_ins) {
  std::vector<Model> models = swapped(model, place, stand_ins.passed, criteria().n_swaps);
  const std::size_t n_more = criteria().n_swaps - models.size();
  if (n_more == 0) return models;
  for (Model& other : nearest(flow, data, swapped(model, place, stand_ins.others, stand_ins.others.size()), n_more))
    models.push_back(std::move(other));
  return models;
}

// What was chosen, and the models that are as good and those that are worse beyond doubt.
struct Best {
  Fit fit;
  std::vector<Model> as_good, worse;
};

// Where a model with more numbers is nearer to the data, the fit may have stopped short: errors of motions that diverge
// have many minima. The nearer one of the fit and of the same model begun where the other one ended.
Fit also_begun_at(Workflow& flow, const FitData& data, const Fit& fit, const Fit& other) {
  std::vector<Fit> again = flow.fitter.begin(data, {with_numbers_of(fit.model, other.model)}, other.delta);
  if (!again.front().succeeded) return fit;
  const Effort effort = effort_of(flow);
  flow.fitter.improve(data, again, effort.n_first_steps + effort.n_more_steps);
  flow.fitter.finish(data, again);
  const double scale = std::min(robust_scale(fit.residual), robust_scale(again.front().residual));
  return robust_cost(again.front().residual, scale) < robust_cost(fit.residual, scale) ? again.front() : fit;
}

Best best_of(Workflow& flow, Prepared& prepared, std::vector<Model> models, const Fit& fit) {
  const FitData& data = prepared.data();
  std::vector<Fit> fits = flow.fitter.begin(data, std::move(models));
  std::erase_if(fits, [](const Fit& other) { return !other.succeeded; });
  // what is far behind the fit that is there already, or behind another, need not be fitted to its end
  const Effort effort = effort_of(flow);
  flow.fitter.improve(data, fits, effort.n_first_steps);
  std::vector<std::vector<VectorXd>> predicted = flow.fitter.predicted(data, fits);
  fits.push_back(fit);
  predicted.push_back(fit.residual);
  give_up_the_last(fits, predicted, effort.n_finalists);
  fits.pop_back();
  flow.fitter.improve(data, fits, effort.n_more_steps);
  flow.fitter.take_last_steps(data, fits);
  flow.fitter.conclude(data, fits);
  fits.push_back(fit);
  Decision decision = decide(data, prepared.base(flow.fitter), fits);
  if (decision.chosen < 0) return {fit, {}, {}};
  if (const Fit& richer = *decision.ranking[std::size_t(decision.chosen)].fit;
      richer.model.x.size() > fit.model.x.size() && !flow.is_costly()) {
    fits.back() = also_begun_at(flow, data, fit, richer);
    decision = decide(data, prepared.base(flow.fitter), fits);
  }
  const std::vector<std::size_t>& same = decision.inseparable;
  Best best{*decision.ranking[std::size_t(decision.chosen)].fit, {}, {}};
  for (std::size_t i = 0; i < decision.ranking.size(); ++i) {
    const Fit& other = *decision.ranking[i].fit;
    if (int(i) == decision.chosen || std::find(same.begin(), same.end(), i) != same.end())
      best.as_good.push_back(other.model);
    else if (!other.is_given_up || other.is_far_behind)  // one for which there was no place may be as good
      best.worse.push_back(other.model);
  }
  return best;
}

// Of models with as many parts that differ in one place at most.
std::vector<std::string> labels_at(std::size_t place, const Model& model, const std::vector<Model>& others) {
  std::vector<std::string> labels;
  for (const Model& other : others) {
    bool is_like_it = other.parts.size() == model.parts.size();
    for (std::size_t i = 0; is_like_it && i < model.parts.size(); ++i)
      is_like_it = i == place || other.parts[i] == model.parts[i];
    if (is_like_it) labels.push_back(other.parts[place]->label());
  }
  return labels;
}

}  // namespace

std::vector<Fit> StandIns::all() const {
  std::vector<Fit> fits = passed;
  if (fits.size() < criteria().n_swaps) fits.insert(fits.end(), others.begin(), others.end());
  return fits;
}

StandIns stand_ins_of(const Decision& decision) {
  StandIns stand_ins;
  for (const Judged& judged : decision.ranking)
    (judged.passes ? stand_ins.passed : stand_ins.others).push_back(*judged.fit);
  return stand_ins;
}

Revision revised(Workflow& flow, Prepared& prepared, const Fit& fit, const StandIns& first_round,
                 const StandIns& this_round) {
  const FitData& data = prepared.data();
  const std::size_t first_place = std::size_t(fit.model.n_nuisances());
  std::vector<Model> models = with_stand_ins(flow, data, fit.model, first_place, first_round);
  for (Model& simpler : each_left_out(fit.model)) models.push_back(std::move(simpler));
  const Best best = best_of(flow, prepared, std::move(models), fit);
  Revision revision{best.fit, labels_at(first_place, fit.model, best.as_good),
                    labels_at(first_place, fit.model, best.worse)};
  const std::vector<const Candidate*>& parts = best.fit.model.parts;
  const auto later = std::find(parts.begin(), parts.end(), fit.model.parts.back());
  if (best.fit.model.effects().size() < 2 || parts == fit.model.parts || later == parts.end()) return revision;
  const std::size_t place = std::size_t(later - parts.begin());
  revision.fit =
      best_of(flow, prepared, swapped(best.fit.model, place, this_round.passed, criteria().n_swaps), best.fit).fit;
  return revision;
}

std::vector<std::string> told_with_first(const std::vector<std::string>& set, const std::string& before,
                                         const std::string& now, const Revision& revision) {
  const auto holds = [](const std::vector<std::string>& labels, const std::string& label) {
    return std::find(labels.begin(), labels.end(), label) != labels.end();
  };
  std::vector<std::string> told = {now};
  const auto add = [&](const std::vector<std::string>& labels) {
    for (const std::string& label : labels)
      if (!holds(told, label) && !holds(revision.worse, label)) told.push_back(label);
  };
  if (!holds(revision.worse, before)) add(set);  // else what mimics it is no look-alike of what took its place
  add(revision.as_good);
  return told.size() > 1 ? told : std::vector<std::string>();
}

}  // namespace pvg::diagnose
