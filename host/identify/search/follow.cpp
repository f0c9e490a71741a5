#include "host/identify/search/follow.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <functional>

#include "host/identify/criteria.hpp"
#include "host/identify/fit/on_whole_runs.hpp"

namespace pvg::diagnose {
namespace {

// Whether a fit is near enough to whole runs with its own numbers, or with those that fit them best; true where that
// cannot be told.
bool may_follow_whole_runs(Workflow& flow, const std::vector<const Fit*>& fits) {
  const double seconds = flow.settings.simulated_seconds;
  std::vector<Model> models;
  for (const Fit* fit : fits) models.push_back(fit->model);
  const auto follow = follow_whole_runs(flow.fitter, flow.problem, seconds, models);
  if (!follow || std::any_of(follow->begin(), follow->end(), std::identity())) return true;
  const auto nearest = std::min_element(fits.begin(), fits.end(),
                                        [](const Fit* a, const Fit* b) { return rms(a->residual) < rms(b->residual); });
  return on_whole_runs(flow.fitter, flow.problem, seconds, **nearest).has_value();
}

}  // namespace

bool any_follows(Workflow& flow, const ChosenWindows& windows, const Round& round) {
  if (round.fits.empty()) return true;
  const bool is_last_resort = are_shortest(windows.data);
  std::vector<const Fit*> near;
  for (const Fit& fit : round.fits)
    if ((!is_last_resort && rms(fit.residual) <= criteria().far_misfit_least) ||
        is_coherent(flow.problem, windows.data, fit, criteria().window_hopeless))
      near.push_back(&fit);
  const double near_noise = criteria().window_hopeless * criteria().window_coherent_floor;
  bool any = std::any_of(near.begin(), near.end(), [&](const Fit* fit) { return rms(fit->residual) <= near_noise; });
  if (!any && !near.empty()) {
    any = true;
    if (is_last_resort)
      flow.ends_in_time(criteria().time_search, "whether any effect follows whole runs",
                        [&] { any = may_follow_whole_runs(flow, near); });
  }
  if (!any)
    flow.notes.push_back(
        fmt::format("with no single effect the scene follows the recorded motion, {:.3g} times the noise away as it "
                    "stands: neither pairs nor laws were looked for; are inputs and rows those of their run?",
                    rms(windows.base.residual)));
  return any;
}

void prefer_what_follows_whole_runs(Workflow& flow, const ChosenWindows& windows, Round& round) {
  const Decision& decision = round.decision;
  if (windows.length == 0 || decision.chosen < 0) return;
  const Judged& chosen = decision.ranking[std::size_t(decision.chosen)];
  std::vector<Model> models = {chosen.fit->model};
  for (const Judged& other : decision.ranking)
    if (&other != &chosen && other.passes &&
        decision.base_error - other.error > criteria().nearly_as_much * (decision.base_error - chosen.error))
      models.push_back(other.fit->model);
  const double seconds = flow.settings.simulated_seconds;
  flow.ends_in_time(criteria().time_search, "which effects follow whole runs", [&] {
    const auto follow = follow_whole_runs(flow.fitter, flow.problem, seconds, models);
    if (!follow || follow->front() || std::none_of(follow->begin(), follow->end(), std::identity()) ||
        on_whole_runs(flow.fitter, flow.problem, seconds, *chosen.fit))
      return;
    flow.notes.push_back(chosen.fit->model.parts.back()->label() +
                         " explains short windows but does not follow whole runs, which another effect does");
    const auto does_follow = [&](const Fit& fit) {
      for (std::size_t i = 0; i < models.size(); ++i)
        if (models[i].parts == fit.model.parts) return bool((*follow)[i]);
      return false;
    };
    const auto refuted = std::stable_partition(round.fits.begin(), round.fits.end(), does_follow);
    round.refuted.assign(refuted, round.fits.end());
    round.fits.erase(refuted, round.fits.end());
    round.decision = decide(windows.data, windows.base, round.fits);
  });
}

bool explains_little(Workflow& flow, const ChosenWindows& windows, const Fit& best) {
  if (gets_nearer(flow.problem, windows.data, windows.base, best.residual)) return false;
  flow.notes.push_back(fmt::format(
      "{}, the best single effect, leaves {:.3g} of {:.3g} times the noise: no second one is looked for beside it; "
      "are inputs and rows those of their run?",
      best.model.parts.back()->label(), rms(best.residual), rms(windows.base.residual)));
  return true;
}

}  // namespace pvg::diagnose
