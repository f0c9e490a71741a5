#include "host/identify/search/plan_next.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "host/identify/criteria.hpp"
#include "host/identify/search/next_experiment.hpp"
#include "host/identify/search/workflow.hpp"

namespace pvg::diagnose {
namespace {

std::string label_of(const RankedModel& model) {
  std::string text;
  for (const Candidate* part : model.parts) text += (text.empty() ? "" : " + ") + part->label();
  return text;
}

// The best other model of the ranking that a set names beside the first one; else simply the next best.
const RankedModel* confused_with_first(const Diagnosis& d) {
  const auto is_confused = [&](const RankedModel& model) {
    return std::any_of(d.inseparable.begin(), d.inseparable.end(), [&](const std::vector<std::string>& set) {
      return std::find(set.begin(), set.end(), model.parts.back()->label()) != set.end();
    });
  };
  for (std::size_t i = 1; i < d.ranking.size(); ++i)
    if (is_confused(d.ranking[i]) && d.ranking[i].parts != d.ranking[0].parts) return &d.ranking[i];
  return d.ranking.size() > 1 ? &d.ranking[1] : nullptr;
}

}  // namespace

void plan_next(Workflow& flow, Device& device, Diagnosis& d) {
  const RankedModel* other = confused_with_first(d);
  if (other == nullptr || !(flow.settings.plans_next || !d.inseparable.empty())) return;
  std::optional<NextExperiment> found;
  const auto end = flow.end_of(criteria().time_proof);
  if (!flow.ends_in_time(criteria().time_proof, "the next experiment", [&] {
        found = next_experiment(device, flow.problem, flow.base, d.ranking[0], *other, flow.settings.n_processes, end);
      }))
    return;
  if (!found) {
    flow.notes.push_back("no motion that could be commanded or released here was found for a next experiment");
    return;
  }
  d.next_experiment =
      fmt::format("{}: separates {} from {} by {:.3g} times the noise, over {} numbers, of {} motions the most{}",
                  found->motion.description, label_of(d.ranking[0]), label_of(*other), found->separation,
                  found->n_samples, motion_family(flow.problem).size(),
                  found->separation < criteria().told_apart ? ", which is not enough to tell them apart" : "");
  d.next_motion = std::move(found->motion);
}

}  // namespace pvg::diagnose
