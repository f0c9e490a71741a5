#include "host/identify/search/round.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

#include "host/base/counted.hpp"
#include "host/identify/criteria.hpp"
#include "host/identify/fit/held_out.hpp"
#include "host/identify/fit/swap.hpp"
#include "host/identify/search/screening.hpp"
#include "host/identify/sensing/world.hpp"

namespace pvg::diagnose {

using Eigen::VectorXd;

namespace {

constexpr std::size_t SCREENED_AT_ONCE = 4;  // candidates between one look at the clock and the next

}  // namespace

Effort effort_of(const Workflow& flow) {
  if (!flow.is_costly()) return {.n_fitted = flow.settings.n_fitted};
  return {.at_once = SCREENED_AT_ONCE,
          .share = criteria().time_screening,
          .n_tried = 0,
          .n_fitted = std::min(criteria().n_fitted_large, flow.settings.n_fitted),
          .n_per_family = 1,
          .n_per_family_beside = 0,
          .response_off_most = criteria().response_off_most,
          .tries_both_sides = false,
          .n_first_steps = 1,
          .n_more_steps = criteria().n_more_steps_large,
          .n_finalists = criteria().n_finalists_large};
}

std::vector<const Candidate*> others_than(const std::vector<Candidate>& all, const Model& model) {
  std::vector<const Candidate*> others;
  for (const Candidate& candidate : all)
    if (std::none_of(model.parts.begin(), model.parts.end(),
                     [&](const Candidate* part) { return part->label() == candidate.label(); }))
      others.push_back(&candidate);
  return others;
}

bool are_shortest(const FitData& data) {
  const double shortest = criteria().window_lengths.back();
  return std::all_of(data.windows.begin(), data.windows.end(), [&](const Window& window) {
    return window.end - window.start < (1 + criteria().window_missing) * shortest;
  });
}

bool gets_nearer(const Problem& problem, const FitData& data, const Fit& base, const std::vector<VectorXd>& left) {
  const double before = rms(base.residual);
  const bool is_near = !(before > criteria().far_misfit_least) &&
                       (!are_shortest(data) || is_coherent(problem, data, base, criteria().window_hopeless));
  if (is_near) return true;
  const bool is_last_resort = are_shortest(data) && base.model.effects().empty();
  return closed(before, rms(left), 1) >= (is_last_resort ? criteria().gap_closed_least : criteria().second_gain_least);
}

void give_up_the_last(std::vector<Fit>& fits, const std::vector<std::vector<VectorXd>>& predicted,
                      std::size_t n_finalists) {
  std::vector<double> scales;  // of each window by the fit that has it best
  for (const Fit& fit : fits) {
    const std::vector<double> of = window_scales(fit.residual);
    if (scales.empty()) scales = of;
    for (std::size_t w = 0; w < of.size(); ++w) scales[w] = std::min(scales[w], of[w]);
  }
  std::vector<double> key;
  for (std::size_t i = 0; i < fits.size(); ++i)
    key.push_back(std::min(robust_cost(fits[i].residual, scales), robust_cost(predicted[i], scales)));
  std::vector<std::size_t> order(fits.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return key[a] < key[b]; });
  for (std::size_t i = 0; i < order.size(); ++i) {
    const Fit& best = fits[order[0]];
    fits[order[i]].is_far_behind =
        key[order[i]] > key[order[0]] + criteria().finalist_behind_most * best.scale * best.scale;
    fits[order[i]].is_given_up = i >= n_finalists || fits[order[i]].is_far_behind;
  }
}

double share_of_steps(double seconds_left, double seconds_of_sensitivities) {
  if (!(seconds_left > 0)) return 0;
  return std::clamp(1 - criteria().sensitivities_at_worst * seconds_of_sensitivities / seconds_left, 0.0,
                    criteria().time_steps);
}

namespace {

// Simulations of a model that the sensitivities of the finalists take at most.
std::size_t n_sensitivities(const std::vector<Fit>& fits, std::size_t n_finalists) {
  std::vector<std::size_t> n;
  for (const Fit& fit : fits) n.push_back(std::size_t(fit.model.x.size()));
  std::sort(n.rbegin(), n.rend());
  n.resize(std::min(n.size(), n_finalists));
  return std::accumulate(n.begin(), n.end(), std::size_t(0));
}

// Where the steps ended for want of time, before or after the finalists were chosen: the finalists, by where they are,
// and those whose sensitivities are known.
void keep_finalists(std::vector<Fit>& fits, std::size_t n_finalists) {
  if (std::none_of(fits.begin(), fits.end(), [](const Fit& fit) { return fit.is_given_up; })) {
    std::vector<std::vector<VectorXd>> left;
    for (Fit& fit : fits) {
      fit.scale = robust_scale(fit.residual);  // no step has found it yet, perhaps
      left.push_back(fit.residual);
    }
    give_up_the_last(fits, left, n_finalists);
  }
  std::erase_if(fits, [](const Fit& fit) { return fit.is_given_up && fit.is_stale; });
}

// The sensitivities of one fit after the other, nearest to the data first. What is not done by the deadline is left
// out, but for the first one.
void conclude_in_time(Fitter& fitter, const FitData& data, std::vector<Fit>& fits) {
  const double scale = std::accumulate(fits.begin(), fits.end(), INFINITY, [](double least, const Fit& fit) {
    return std::min(least, robust_scale(fit.residual));
  });
  std::stable_sort(fits.begin(), fits.end(), [&](const Fit& a, const Fit& b) {
    return robust_cost(a.residual, scale) < robust_cost(b.residual, scale);
  });
  std::vector<Fit> done;
  for (Fit& fit : fits) {
    std::vector<Fit> one{fit};
    try {
      fitter.conclude(data, one);
    } catch (const OutOfTime&) {
      if (done.empty()) throw;
      break;
    }
    done.push_back(std::move(one.front()));
  }
  fits = std::move(done);
}

// Some steps of all fits, then those of the finalists to their end. False where none gets nearer to the data: all are
// given up.
bool improve_finalists(Workflow& flow, const FitData& data, const Fit& base, std::vector<Fit>& fits) {
  Fitter& fitter = flow.fitter;
  const Effort effort = effort_of(flow);
  fitter.improve(data, fits, effort.n_first_steps);
  const std::vector<std::vector<VectorXd>> predicted = fitter.predicted(data, fits);
  std::vector<std::vector<VectorXd>> left = predicted;
  for (const Fit& fit : fits) left.push_back(fit.residual);
  if (std::none_of(left.begin(), left.end(),
                   [&](const auto& residual) { return gets_nearer(flow.problem, data, base, residual); })) {
    for (Fit& fit : fits) fit.is_given_up = true;
    return false;
  }
  give_up_the_last(fits, predicted, effort.n_finalists);
  fitter.improve(data, fits, effort.n_more_steps);
  fitter.take_last_steps(data, fits);
  return true;
}

}  // namespace

std::vector<Fit> fit_best(Workflow& flow, const FitData& data, const Fit& base, const std::vector<Screened>& best) {
  Fitter& fitter = flow.fitter;
  std::vector<Model> models;
  for (const Screened& s : best) models.push_back(s.model);
  const Clock::time_point began = Clock::now();
  std::vector<Fit> fits = fitter.begin(data, std::move(models));
  const double of_model = -seconds_until(began) / double(std::max<std::size_t>(fits.size(), 1));
  std::erase_if(fits, [](const Fit& fit) { return !fit.succeeded; });
  const std::size_t n_finalists = effort_of(flow).n_finalists;
  double share =
      share_of_steps(seconds_until(fitter.deadline()), of_model * double(n_sensitivities(fits, n_finalists)));
  const bool is_of_one = !fits.empty() && fits.front().model.effects().size() == 1;
  if (flow.is_costly() && is_of_one && flow.settings.max_effects > 1)
    share = std::min(share, criteria().time_first_steps);
  bool any_nearer = true;
  if (!ends_by(fitter.deadline(), after_share(fitter.deadline(), share),
               [&] { any_nearer = improve_finalists(flow, data, base, fits); })) {
    flow.note_left_out("the last steps of fits");
    keep_finalists(fits, n_finalists);
    conclude_in_time(fitter, data, fits);
    return fits;
  }
  if (!any_nearer)
    flow.notes.push_back(
        fmt::format("{} models end after their first steps: none gets near the data, {:.3g} times the noise away",
                    fits.size(), rms(base.residual)));
  fitter.conclude(data, fits);
  return fits;
}

namespace {

void begin_at_ends(Fitter& fitter, const FitData& data, const std::vector<Model>& ends, std::vector<Screened>& best) {
  std::vector<Model> models;
  std::vector<Screened*> owner;
  for (Screened& screened : best)
    for (const Model& end : ends) {
      if (end.parts != screened.model.parts) continue;
      models.push_back(screened.model);
      models.push_back(end);
      owner.push_back(&screened);
    }
  const std::vector<Fit> fits = fitter.begin(data, std::move(models));
  for (std::size_t i = 0; i < owner.size(); ++i) {
    const Fit &first = fits[2 * i], &end = fits[2 * i + 1];
    const double scale = robust_scale(first.residual);
    if (end.succeeded && !(robust_cost(first.residual, scale) < robust_cost(end.residual, scale)))
      owner[i]->model = end.model;
  }
}

// Simulations of the shortest next round that decides anything, in one window: its models where they begin, and the
// sensitivities of its finalists; twice, since the machine may become busier.
std::size_t n_least_of_next(const std::vector<Fit>& fits, const Effort& effort) {
  Eigen::Index n_parameters = 0;
  for (const Fit& fit : fits) n_parameters = std::max(n_parameters, fit.model.x.size());
  return 2 * (effort.n_fitted + effort.n_finalists * std::size_t(n_parameters + 1));
}

}  // namespace

Round run_round(Workflow& flow, const std::vector<Candidate>& all, const FitData& data, const Fit& base,
                const std::string& name, double progress, const std::vector<Model>& ends, const Changes& known) {
  std::vector<const Candidate*> candidates = others_than(all, base.model);
  if (flow.settings.decide == Decide::retune)
    std::erase_if(candidates, [](const Candidate* candidate) { return candidate->family != Family::parameter; });
  Round round;
  const bool is_first = base.model.effects().empty();
  const Effort effort = effort_of(flow);
  std::vector<Screened> screened;
  if (!known.trials.empty() && flow.is_costly() && are_in(known, data)) {
    screened = screen_by_changes(data, base, candidates, known);
  } else {
    const Screening screening(flow, data, base);
    ScreeningResult result =
        screen(screening.fitter, screening.data, base, candidates, is_first ? &round.signatures : nullptr, effort);
    if (result.n_screened < candidates.size())
      flow.note_left_out(fmt::format("{} of {}, the last of their kinds by the place of the misfit",
                                     candidates.size() - result.n_screened, counted(candidates.size(), "candidate")));
    screened = std::move(result.best);
    if (flow.is_costly()) round.changes = std::move(result.changes);
  }
  flow.files.write_screen(name, screened);
  if (is_first) flow.show(identifiability(round.signatures));
  const double fits_began = flow.seconds();
  const std::size_t n_simulations = flow.predictor.n_simulations();
  std::vector<Screened> best =
      shortlist(screened, effort.n_fitted, is_first ? effort.n_per_family : effort.n_per_family_beside);
  for (Model& model : with_wrong_numbers(base.model, all)) best.push_back({model.parts.back(), std::move(model), 0, 0});
  if (!ends.empty()) begin_at_ends(flow.fitter, data, ends, best);
  flow.report_progress(5, progress,
                       "fitting " + std::to_string(best.size()) + " of " + counted(candidates.size(), "candidate"));
  if (best.empty()) return round;
  if (flow.settings.decide == Decide::weak) {  // as the linear regression has them
    round.fits = flow.fitter.begin(data, {best[0].model});
    std::erase_if(round.fits, [](const Fit& fit) { return !fit.succeeded; });
    flow.fitter.conclude(data, round.fits);
  } else {
    round.fits = fit_best(flow, data, base, best);
  }
  round.decision =
      flow.settings.decide == Decide::workflow ? decide(data, base, round.fits) : decide_lowest(base, round.fits);
  flow.files.write_fits(name, round.decision);
  round.seconds_of_fits = flow.seconds() - fits_began;
  if (flow.is_costly())
    round.seconds_of_fits *= double(n_least_of_next(round.fits, effort)) /
                             double(std::max<std::size_t>(flow.predictor.n_simulations() - n_simulations, 1));
  return round;
}

}  // namespace pvg::diagnose
