#include "host/identify/search/plan_next.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>

#include "host/base/counted.hpp"
#include "host/identify/criteria.hpp"
#include "host/identify/search/next_experiment.hpp"

namespace pvg::diagnose {
namespace {

std::string label_of(const RankedModel& model) {
  std::string text;
  for (const Candidate* part : model.parts) text += (text.empty() ? "" : " + ") + part->label();
  return text;
}

// The best other models of the ranking that a set names beside the first one; else simply the next best.
RankedModels confused_with_first(const Diagnosis& d) {
  const auto is_confused = [&](const RankedModel& model) {
    return std::any_of(d.inseparable.begin(), d.inseparable.end(), [&](const std::vector<std::string>& set) {
      return std::find(set.begin(), set.end(), model.parts.back()->label()) != set.end();
    });
  };
  RankedModels confused;
  for (std::size_t i = 1; i < d.ranking.size() && confused.size() < criteria().next_names_most; ++i)
    if (is_confused(d.ranking[i]) && d.ranking[i].parts != d.ranking[0].parts) confused.push_back(&d.ranking[i]);
  if (confused.empty() && d.ranking.size() > 1) confused.push_back(&d.ranking[1]);
  return confused;
}

// "separates A from B by 12 times the noise, not from C (0.3)"
std::string separation_sentence(const std::string& first, const RankedModels& others, const std::vector<double>& by) {
  std::string apart, confused;
  for (std::size_t k = 0; k < others.size(); ++k) {
    const bool is_apart = by[k] >= criteria().told_apart;
    std::string& list = is_apart ? apart : confused;
    list +=
        (list.empty() ? ""
         : is_apart   ? ", from "
                      : " or ") +
        label_of(*others[k]) +
        (is_apart ? fmt::format(" by {:.3g} times the noise", by[k]) : fmt::format(" ({:.2g} times the noise)", by[k]));
  }
  if (apart.empty())
    return "separates " + first + " from none of " + confused + ", which is not enough to tell them apart";
  return "separates " + first + " from " + apart + (confused.empty() ? "" : ", not from " + confused);
}

}  // namespace

bool wants_next(const Settings& settings, const Diagnosis& d) {
  return !confused_with_first(d).empty() && (settings.plans_next || !d.inseparable.empty());
}

void plan_next(Device& device, const Problem& problem, const Settings& settings, Diagnosis& d) {
  if (!wants_next(settings, d)) return;
  const RankedModels others = confused_with_first(d);
  const auto start = Clock::now();
  const double seconds = std::min(60 * settings.minutes * criteria().time_next, 60 * settings.minutes - d.seconds);
  const auto deadline = start + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
  NextExperiment found = next_experiment(device, problem, d.base, d.ranking[0], others, settings.n_processes, deadline);
  d.seconds -= seconds_until(start);
  if (!found.had_time)
    d.left_out.push_back(
        fmt::format("a part of the search for a next experiment: {} of {} were simulated in "
                    "{:.0f} s; `--minutes`, which is {:g}, gives it more",
                    found.n_simulated, counted(found.n_motions, "motion"), std::max(seconds, 0.0), settings.minutes));
  if (found.n_samples == 0) {
    if (found.had_time)
      d.notes.push_back("no motion that could be commanded or released here was found for a next experiment");
    return;
  }
  d.next_experiment = fmt::format("{}: {}, over {}, of {} the most", found.motion.description,
                                  separation_sentence(label_of(d.ranking[0]), others, found.separation),
                                  counted(found.n_samples, "number"), counted(found.n_simulated, "motion"));
  d.next_motion = std::move(found.motion);
}

}  // namespace pvg::diagnose
