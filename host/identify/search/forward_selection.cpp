#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "host/identify/criteria.hpp"
#include "host/identify/fit/on_whole_runs.hpp"
#include "host/identify/fit/prepared.hpp"
#include "host/identify/search/finer_steps.hpp"
#include "host/identify/search/follow.hpp"
#include "host/identify/search/pairs.hpp"
#include "host/identify/search/prove.hpp"
#include "host/identify/search/revise.hpp"
#include "host/identify/search/round.hpp"
#include "host/identify/search/screen.hpp"
#include "host/identify/search/workflow.hpp"

namespace pvg::diagnose {
namespace {

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

// The left-out error of another single effect in the present preparation, after some steps there: infinite where it
// fails there.
double error_of_single(Workflow& flow, Prepared& prepared, const Model& model, int n_steps) {
  std::vector<Fit> fits = flow.fitter.begin(prepared.data(), {model});
  flow.fitter.improve(prepared.data(), fits, n_steps);
  flow.fitter.finish(prepared.data(), fits);
  const Decision decision = decide(prepared.data(), prepared.base(flow.fitter), fits);
  return decision.ranking.empty() ? INFINITY : decision.ranking.front().error;
}

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
    const auto is_worse = [&](const Fit& fit) {
      return fit.succeeded && (!fit.is_given_up || fit.is_far_behind) && fit.model.parts.back() == other;
    };
    const bool any_worse = std::any_of(round.fits.begin(), round.fits.end(), is_worse) ||
                           std::any_of(round.refuted.begin(), round.refuted.end(), is_worse);
    if (!any_worse) labels.push_back(other->label());
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

// One effect after the other, then sums of two. `out` is whole after each effect: the time may be over in the search
// for the next one.
class ForwardSelection {
 public:
  ForwardSelection(Workflow& flow, const std::vector<Candidate>& candidates, const ChosenWindows& windows,
                   const std::vector<Model>& ends, Selection& out)
      : flow_(flow), candidates_(candidates), windows_(windows), ends_(ends), out_(out) {}

  void run() {
    // one round more than effects, since a swap takes one
    const int n_rounds = flow_.settings.max_effects + (flow_.settings.max_effects > 1);
    Next next = Next::another_round;
    for (int number = 1; number <= n_rounds && next == Next::another_round; ++number) next = add_effect(number);
    if (next == Next::nothing || flow_.settings.max_effects < 2 || !is_workflow()) return;
    if (tells_of_pairs()) look_for_pairs();
  }

 private:
  enum class Next { another_round, pairs, nothing };

  bool is_workflow() const { return flow_.settings.decide == Decide::workflow; }
  int n_named() const { return int(named_.model.effects().size()); }
  double length() const { return is_of_whole_runs_ ? 0 : windows_.length; }

  Next add_effect(int number) {
    if (n_named() >= flow_.settings.max_effects) return Next::pairs;
    if (number > 1 && !flow_.has_time("an effect beside " + named_.model.parts.back()->label(), of_next_round_))
      return Next::nothing;
    const double since = flow_.seconds();
    if (n_named() == 1) tried_.push_back(of_windows_);
    const double progress = number == 1 ? 0.4 : 0.75;
    Round round = run_round(flow_, candidates_, prepared_.data(), named_, std::to_string(number), progress,
                            number == 1 ? ends_ : std::vector<Model>(), changes_);
    const double of_round = flow_.seconds() - since;
    of_rounds_ += of_round;
    if (number == 1) {
      changes_ = std::move(round.changes);
      signatures_ = round.signatures;
    }
    of_next_round_ = changes_.trials.empty() ? of_round : round.seconds_of_fits;
    if (number == 1 && is_workflow()) {
      out_.follows = any_follows(flow_, windows_, round);
      if (out_.follows) prefer_what_follows_whole_runs(flow_, windows_, round);
    }
    const Decision& decision = round.decision;
    if (number == 1)
      for (const Judged& judged : decision.ranking) out_.ranking.push_back(ranked(judged));
    if (decision.chosen < 0) return out_.follows ? Next::pairs : Next::nothing;
    const Judged& chosen = decision.ranking[std::size_t(decision.chosen)];
    if (number > 1 && !closes_enough_of_the_rest(decision, chosen)) return Next::pairs;
    if (number == 1)
      std::rotate(out_.ranking.begin(), out_.ranking.begin() + decision.chosen,
                  out_.ranking.begin() + decision.chosen + 1);
    const std::vector<std::string> set = not_told_apart(round, chosen, number);
    if (number > 1) keep_alternatives(decision);
    const StandIns this_round = stand_ins_of(decision);
    if (number == 1) {
      first_round_ = this_round;
      for (const Judged& judged : decision.ranking)
        if (judged.passes) error_of_first_passed_ = std::min(error_of_first_passed_, judged.error);
    }
    const Fit before = std::exchange(named_, *chosen.fit);
    if (number == 1 && is_workflow() && (!out_.follows || explains_little(flow_, windows_, named_))) {
      take(chosen, set, number);
      return out_.follows ? Next::pairs : Next::nothing;
    }
    // all is searched again with the finer step, which takes as long as the rounds so far
    if (is_workflow() && flow_.may_refine_step && !is_step_left_out_)
      is_step_left_out_ = !flow_.has_time("whether what was found needs a finer time step", of_rounds_);
    if (is_workflow() && !is_step_left_out_ && flow_.refine_step(named_.model)) {
      out_ = Selection();
      out_.asks_for_new_step = true;
      for (const Fit& fit : round.fits) out_.ends.push_back(fit.model);
      return Next::nothing;
    }
    if (is_workflow() && !is_refitted_soon(number)) revise(chosen, this_round);
    if (leaves_more_than_the_scene()) {
      flow_.notes.push_back(
          chosen.fit->model.parts.back()->label() +
          " leaves more, once starts and steps are those of it, than the scene as it stands: not taken");
      named_ = before;
      return Next::pairs;
    }
    measure_in_whole_runs();
    const bool is_newest_dropped = take(chosen, set, number);
    if (decision.better_at_bound >= 0 && is_workflow())
      out_.better_at_bound = labels_of(decision.ranking[std::size_t(decision.better_at_bound)].fit->model).back();
    is_explained_ =
        is_workflow() ? is_explained(flow_, prepared_.data(), named_, length()) : out_.error < criteria().unexplained;
    if (is_newest_dropped || is_explained_) return Next::pairs;
    if (n_named() < flow_.settings.max_effects)
      flow_.report_progress(4, 0.6,
                            "what " + named_.model.parts.back()->label() + " leaves is " + std::to_string(out_.error) +
                                " times the noise: looking for another effect");
    return Next::another_round;
  }

  // A second effect also helps where the law of the first is not quite right; another single effect may help as much.
  bool closes_enough_of_the_rest(const Decision& decision, const Judged& chosen) {
    const bool is_another =
        !first_round_.passed.empty() && first_round_.passed.front().model.parts != named_.model.parts;
    // where a simulation takes seconds it was fitted just now, to the same preparation
    const double of_another =
        !is_another ? INFINITY
        : changes_.trials.empty()
            ? error_of_single(flow_, prepared_, first_round_.passed.front().model, criteria().n_more_steps)
            : error_of_first_passed_;
    return closed(std::min(decision.base_error, of_another), chosen.error, 1) >= criteria().second_gain_least;
  }

  void keep_alternatives(const Decision& decision) {
    const std::vector<std::size_t>& same = decision.inseparable;
    for (std::size_t i = 0; i < decision.ranking.size(); ++i)
      if (int(i) != decision.chosen && std::find(same.begin(), same.end(), i) == same.end())
        out_.alternatives.push_back(decision.ranking[i].fit->model);
  }

  // What these recordings do not tell from the effect that was chosen, that one among them; empty: nothing.
  std::vector<std::string> not_told_apart(const Round& round, const Judged& chosen, int number) const {
    std::vector<std::string> set;
    for (const std::size_t i : round.decision.inseparable) {
      const std::vector<std::string> labels = labels_of(round.decision.ranking[i].fit->model, named_.model);
      set.insert(set.end(), labels.begin(), labels.end());
    }
    if (number > 1 || !is_workflow()) return set;
    for (const std::string& label : told_together(round, chosen)) {
      if (std::find(set.begin(), set.end(), label) != set.end()) continue;
      if (set.empty()) set.push_back(chosen.fit->model.parts.back()->label());
      set.push_back(label);
    }
    return set;
  }

  // Where a simulation takes seconds the steps to the end of a first effect that leaves much are those of the next
  // round, beside a second one.
  bool is_refitted_soon(int number) const {
    return number == 1 && !changes_.trials.empty() && flow_.settings.max_effects > 1 &&
           rms(named_.residual) >= criteria().unexplained;
  }

  void revise(const Judged& chosen, const StandIns& this_round) {
    flow_.ends_in_time(criteria().time_search, "the revision of " + labels_of(named_.model).back(), [&] {
      if (chosen.fit->model.effects().size() > 1) {
        revision_ = revised(flow_, prepared_, *chosen.fit, first_round_, this_round);
        named_ = revision_.fit;
      }
      named_ = prepared_again(flow_.fitter, prepared_, named_, effort_of(flow_).n_more_steps);
    });
  }

  bool leaves_more_than_the_scene() {
    const Fit& scene = is_of_whole_runs_ ? prepared_.base(flow_.fitter) : windows_.base;
    return robust_cost(named_.residual, named_.scale) > robust_cost(scene.residual, named_.scale);
  }

  void measure_in_whole_runs() {
    if (!is_of_whole_runs_) of_windows_ = named_;
    if (windows_.length > 0 && !is_of_whole_runs_ && is_workflow())
      flow_.ends_in_time(criteria().time_search, labels_of(named_.model).back() + " on whole runs",
                         [&] { is_of_whole_runs_ = go_to_whole_runs(flow_, prepared_, named_); });
  }

  // What is named now becomes the selection. Whether the newest effect was dropped in the revision: these are the same
  // effects as before, at a better optimum.
  bool take(const Judged& chosen, const std::vector<std::string>& set, int number) {
    const Model& found = chosen.fit->model;
    const bool any_dropped = n_named() < int(found.effects().size());
    const bool is_newest_dropped = any_dropped && begins_with(found.effects(), named_.model.effects());
    out_.error = rms(named_.residual);
    if (is_newest_dropped) {
      std::erase_if(out_.ranking, [&](const RankedModel& model) { return model.parts == named_.model.effects(); });
      out_.fits.pop_back();
    } else {
      if (!any_dropped && n_named() > 1) renew_set_of_first(found);
      if (!set.empty()) out_.inseparable.push_back(set);
      if (any_dropped) {  // the first effect was
        out_.fits.clear();
        out_.inseparable.clear();
      }
    }
    if (number > 1)
      out_.ranking.insert(out_.ranking.begin(), named_.model.parts == found.parts
                                                    ? ranked(chosen)
                                                    : ranked(named_, out_.error, chosen.evidence, chosen.probability));
    out_.fits.push_back(named_);
    out_.windows = prepared_.data().windows;
    out_.better_at_bound.clear();
    return is_newest_dropped;
  }

  // The first effect's set is of a time when the second was missing. found: as the revision began.
  void renew_set_of_first(const Model& found) {
    const std::vector<std::string> set =
        told_with_first(out_.inseparable.empty() ? std::vector<std::string>() : out_.inseparable.front(),
                        labels_of(found).front(), labels_of(named_.model).front(), revision_);
    if (out_.fits.size() == 1) out_.inseparable_of_one = out_.inseparable;
    out_.inseparable.clear();
    if (!set.empty()) out_.inseparable.push_back(set);
  }

  // Short windows that one effect explains tell nothing of pairs.
  bool tells_of_pairs() const {
    return out_.fits.empty() ||
           (!is_explained_ && (windows_.length == 0 || rms(of_windows_.residual) >= criteria().unexplained));
  }

  void look_for_pairs() {
    // a pair has to be better than what is named already
    const double left = out_.fits.empty() ? INFINITY : std::min(rms(named_.residual), rms(of_windows_.residual));
    const double most = std::min(criteria().unexplained, left);
    const auto is_better = [&](const std::optional<FoundPair>& pair) {
      return pair && (left >= criteria().unexplained || is_explained(flow_, windows_.data, pair->fit, windows_.length));
    };
    if (!flow_.has_time("a pair of effects", of_next_round_)) return;
    const std::vector<Fit> alternatives =
        alternatives_of(flow_, windows_.data, windows_.base, first_round_.all(), tried_);
    if (const std::optional<FoundPair> pair =
            find_pair(flow_, candidates_, windows_.data, windows_.base, alternatives, most, {signatures_, changes_});
        is_better(pair)) {
      out_.inseparable.clear();
      take(*pair);
    }
  }

  void take(const FoundPair& pair) {
    Prepared first(windows_.data, windows_.base);
    Fit fit = pair.fit;
    flow_.ends_in_time(criteria().time_search, "the revision of a pair",
                       [&] { fit = prepared_again(flow_.fitter, first, fit, effort_of(flow_).n_more_steps); });
    out_.fits = {std::move(fit)};
    out_.windows = first.data().windows;
    out_.better_at_bound.clear();
    out_.error = rms(out_.fits.back().residual);
    out_.ranking.insert(out_.ranking.begin(), pair.model);
    if (!pair.inseparable.empty()) out_.inseparable.push_back(pair.inseparable);
  }

  Workflow& flow_;
  const std::vector<Candidate>& candidates_;
  const ChosenWindows& windows_;
  const std::vector<Model>& ends_;  // of the first round with another time step
  Selection& out_;
  Prepared prepared_{windows_.data, windows_.base};
  Fit named_ = windows_.base, of_windows_ = windows_.base;  // of_windows_: before whole runs took their place
  StandIns first_round_;
  double error_of_first_passed_ = INFINITY;   // left out [noise]
  Revision revision_;                         // of two effects
  std::vector<Fit> tried_;                    // single ones beside which a second was looked for
  Changes changes_;                           // of the first round, where nothing else is screened
  Signatures signatures_;                     // likewise
  double of_rounds_ = 0, of_next_round_ = 0;  // how long all took so far, and another one is expected to [s]
  bool is_of_whole_runs_ = false, is_explained_ = false, is_step_left_out_ = false;
};

}  // namespace

Selection forward_selection(Workflow& flow, const std::vector<Candidate>& candidates, const ChosenWindows& chosen,
                            const std::vector<Model>& ends) {
  Selection out;
  out.error = rms(chosen.base.residual);
  flow.ends_in_time(criteria().time_search, "the rest of the search for effects",
                    [&] { ForwardSelection(flow, candidates, chosen, ends, out).run(); });
  if (out.fits.empty() || flow.settings.decide != Decide::workflow) return out;
  use_finer_steps(flow, out);
  const Fit& found = out.fits.back();
  for (RankedModel& model : out.ranking)
    if (model.parts == found.model.effects()) model = ranked(found, model.error, model.evidence, model.probability);
  return out;
}

}  // namespace pvg::diagnose
