#include <algorithm>
#include <cmath>
#include <numeric>

#include "pipeline/diagnose/pairs.hpp"
#include "pipeline/diagnose/screen.hpp"
#include "pipeline/diagnose/workflow.hpp"

namespace pvg::diagnose {
namespace {

using Eigen::VectorXd;
constexpr double LEAST_STEP =
    0.2;  // of what is left on fitting runs, for a further effect to be tried on held-out ones
constexpr double SECOND_LOOK = 1.5;        // times the noise floor: look for another effect
constexpr std::size_t N_FINALISTS = 5;     // candidates that are fitted to the end
constexpr int MORE_STEPS = 10;             // of these
constexpr std::size_t MOST_EXCHANGED = 3;  // other first effects that are tried beside a second one
constexpr double HOPELESS = 100;           // by which a finalist's log-likelihood may be worse than the best one's

std::vector<std::string> labels_of(const Model& model, std::size_t after) {
  std::vector<std::string> labels;
  for (std::size_t i = after; i < model.parts.size(); ++i) labels.push_back(model.parts[i]->label());
  return labels;
}

// One round: screen all candidates beside what is in the base already, fit the best, decide.
struct Round {
  std::vector<Fit> fits;
  Decision decision;
};

Round run_round(Workflow& flow, const FitData& data, const Fit& base, int number) {
  std::vector<const Candidate*> candidates;
  for (const Candidate& c : *flow.out.candidates)
    if (std::find(base.model.parts.begin(), base.model.parts.end(), &c) == base.model.parts.end() &&
        (flow.settings.decide != Decide::retune || c.family == Family::parameter))
      candidates.push_back(&c);
  const std::vector<Screened> screened = screen(flow.fitter, data, base, candidates);
  flow.files.write_screen(number, screened);
  const std::vector<Screened> best = shortlist(screened, flow.settings.n_fitted);
  flow.tell(5, number == 1 ? 0.4 : 0.75,
            "fitting " + std::to_string(best.size()) + " of " + std::to_string(candidates.size()) + " candidates");
  Round round;
  if (best.empty()) return round;
  if (flow.settings.decide == Decide::weak) {  // as the linear regression has them
    round.fits = flow.fitter.begin(data, {best[0].model});
    std::erase_if(round.fits, [](const Fit& fit) { return !fit.is_well; });
    flow.fitter.conclude(data, round.fits);
  } else {
    round.fits = fit_best(flow.fitter, data, best);
  }
  round.decision =
      flow.settings.decide == Decide::workflow ? decide(data, base, round.fits) : decide_lowest(base, round.fits);
  return round;
}

Model without(const Model& model, std::size_t left_out) {
  Model less;
  std::vector<double> x, scale;
  Eigen::Index at = 0;
  for (std::size_t i = 0; i < model.parts.size(); ++i) {
    for (std::size_t k = 0; k < model.parts[i]->parameters.size(); ++k, ++at)
      if (i != left_out) x.push_back(model.x[at]), scale.push_back(model.scale[at]);
    if (i != left_out) less.parts.push_back(model.parts[i]);
  }
  less.x = Eigen::Map<const VectorXd>(x.data(), Eigen::Index(x.size()));
  less.scale = Eigen::Map<const VectorXd>(scale.data(), Eigen::Index(scale.size()));
  return less;
}

// Others of the first round in place of the model's first part.
std::vector<Model> exchanged(const Model& model, const std::vector<Fit>& first_round) {
  std::vector<Model> models;
  const Model rest = without(model, 0);
  for (const Fit& first : first_round) {
    const Candidate* part = first.model.parts.front();
    if (models.size() >= MOST_EXCHANGED) break;
    if (std::find(model.parts.begin(), model.parts.end(), part) != model.parts.end()) continue;
    Model other = first.model;
    other.parts.insert(other.parts.end(), rest.parts.begin(), rest.parts.end());
    other.x.conservativeResize(first.model.x.size() + rest.x.size());
    other.x.tail(rest.x.size()) = rest.x;
    other.scale.conservativeResize(other.x.size());
    other.scale.tail(rest.x.size()) = rest.scale;
    models.push_back(std::move(other));
  }
  return models;
}

// An effect that was found first may only have stood in: for one that was found later, without it the fit is as good
// then; or for another of the first round, which is better beside what was found later.
Fit reconsidered(Workflow& flow, const FitData& data, const Fit& base, const Fit& fit,
                 const std::vector<Fit>& first_round) {
  std::vector<Model> models = exchanged(fit.model, first_round);
  for (std::size_t i = 0; i + 1 < fit.model.parts.size(); ++i) models.push_back(without(fit.model, i));
  std::vector<Fit> fits = flow.fitter.begin(data, std::move(models));
  std::erase_if(fits, [](const Fit& other) { return !other.is_well; });
  flow.fitter.improve(data, fits, MORE_STEPS);
  flow.fitter.finish(data, fits);
  fits.push_back(fit);
  const Decision decision = decide(data, base, fits);
  return decision.chosen >= 0 ? *decision.ranking[std::size_t(decision.chosen)].fit : fit;
}

// What a coarse time step does wrong, and how the windows answer to their starts, is another matter with the effect
// than without: both are found again there, and the fit goes on.
Fit settled(Workflow& flow, FitData& data, const Fit& fit) {
  FitData near = flow.fitter.prepare_near(data.windows, fit.model);
  if (near.windows.size() != data.windows.size()) return fit;
  Fit better = flow.fitter.fit(near, {fit.model}, MORE_STEPS).front();
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

std::vector<Fit> fit_best(Fitter& fitter, const FitData& data, const std::vector<Screened>& best) {
  std::vector<Model> models;
  for (const Screened& s : best) models.push_back(s.model);
  std::vector<Fit> fits = fitter.begin(data, std::move(models));
  std::erase_if(fits, [](const Fit& fit) { return !fit.is_well; });
  fitter.improve(data, fits, 2);
  std::vector<double> scales;  // of each window by the fit that has it best
  for (const Fit& fit : fits) {
    const std::vector<double> of = window_scales(fit.residual);
    if (scales.empty()) scales = of;
    for (std::size_t w = 0; w < of.size(); ++w) scales[w] = std::min(scales[w], of[w]);
  }
  // who is worth more steps is told by what the next one promises: the true effect may still be far from its best
  const std::vector<std::vector<VectorXd>> promised = fitter.promised(data, fits);
  std::vector<double> key;
  for (std::size_t i = 0; i < fits.size(); ++i)
    key.push_back(std::min(robust_cost(fits[i].residual, scales), robust_cost(promised[i], scales)));
  std::vector<std::size_t> order(fits.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return key[a] < key[b]; });
  for (std::size_t i = 0; i < order.size(); ++i) {
    const Fit& best = fits[order[0]];
    fits[order[i]].is_given_up = i >= N_FINALISTS || key[order[i]] > key[order[0]] + HOPELESS * best.scale * best.scale;
  }
  fitter.improve(data, fits, MORE_STEPS);
  fitter.finish(data, fits);
  return fits;
}

std::vector<Fit> grow(Workflow& flow, FitData data, const Fit& base) {
  Diagnosis& out = flow.out;
  std::vector<Fit> grown, first_round;
  double least_of_one = INFINITY;  // left-out error, of those that pass in the first round
  double of_round = 0;             // how long the last one took [s]
  Fit named = base;
  // one round more than effects, for one that took another's place
  for (int number = 1; number <= flow.settings.max_effects + (flow.settings.max_effects > 1); ++number) {
    if (int(named.model.parts.size()) >= flow.settings.max_effects) break;
    if (number > 1 && !flow.has_time("an effect beside " + named.model.parts.back()->label(), of_round)) return grown;
    const double since = flow.seconds();
    const Round round = run_round(flow, data, named, number);
    of_round = flow.seconds() - since;
    flow.files.write_fits(std::to_string(number), round.decision);
    const Decision& decision = round.decision;
    if (number == 1)
      for (const Judged& judged : decision.ranking) out.ranking.push_back(ranked(judged));
    if (decision.chosen < 0) break;
    const Judged& chosen = decision.ranking[std::size_t(decision.chosen)];
    // beside an effect whose law is not quite right a second one helps, as another single one may as well
    if (number > 1 && closed(std::min(decision.base_error, least_of_one), chosen.error, 1) < LEAST_STEP) break;
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
    if (number == 1)
      for (const Judged& judged : decision.ranking)
        if (judged.passes) {
          first_round.push_back(*judged.fit);
          least_of_one = std::min(least_of_one, judged.error);
        }
    named = n_parts > 1 && flow.settings.decide == Decide::workflow
                ? reconsidered(flow, data, base, *chosen.fit, first_round)
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
    if (error < SECOND_LOOK) break;
    if (int(named.model.parts.size()) < flow.settings.max_effects)
      flow.tell(4, 0.6,
                "what " + named.model.parts.back()->label() + " leaves is " + std::to_string(error) +
                    " times the noise: looking for another effect");
  }
  const bool is_explained = !grown.empty() && rms(named.residual) < SECOND_LOOK;
  if (is_explained || flow.settings.max_effects < 2 || flow.settings.decide != Decide::workflow) return grown;
  if (!flow.has_time("a pair of effects", of_round)) return grown;
  if (const std::optional<Fit> pair = find_pair(flow, data, base, SECOND_LOOK)) {
    grown = {settled(flow, data, *pair)};
    out.fit_after = rms(grown.back().residual);
  }
  return grown;
}

}  // namespace pvg::diagnose
