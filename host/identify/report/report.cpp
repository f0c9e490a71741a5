#include "host/identify/report/report.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "host/base/atomic_files.hpp"
#include "host/base/counted.hpp"
#include "host/identify/criteria.hpp"
#include "host/model/effect.hpp"

namespace pvg::diagnose {
namespace {

using json = nlohmann::ordered_json;
constexpr std::size_t MOST_ALTERNATIVES = 3;                   // that a sentence holds
constexpr double LEAST_ON_EARTH = 9.76, MOST_ON_EARTH = 9.84;  // gravity at the ground [m/s^2]

// One standard deviation, or both ends where the interval of two reaches much farther up than down.
std::string with_interval(const NamedParameter& p) {
  const bool is_lopsided = p.high - p.value > 2 * (p.value - p.low);
  const std::string interval =
      is_lopsided ? " (" + shown(p.low) + " to " + shown(p.high) + ")" : " +- " + shown((p.high - p.low) / 4);
  return p.name + " " + shown(p.value) + interval + (p.unit == "1" ? "" : " " + p.unit);
}

// " (these data cannot tell it from linear_drag at ball)": the other names of the sets that hold this one.
std::string alternatives_of(const Diagnosis& d, const std::string& label) {
  std::vector<std::string> others;
  for (const std::vector<std::string>& set : d.inseparable) {
    if (std::find(set.begin(), set.end(), label) == set.end()) continue;
    for (const std::string& other : set) {
      const bool is_named = std::any_of(d.effects.begin(), d.effects.end(),
                                        [&](const NamedEffect& e) { return e.candidate->label() == other; });
      if (!is_named && std::find(others.begin(), others.end(), other) == others.end()) others.push_back(other);
    }
  }
  if (others.empty()) return "";
  std::string text = " (these data cannot tell it from " + others[0];
  for (std::size_t i = 1; i < std::min(others.size(), MOST_ALTERNATIVES); ++i) text += " or " + others[i];
  if (others.size() > MOST_ALTERNATIVES) text += " or " + counted(others.size() - MOST_ALTERNATIVES, "other");
  return text + ")";
}

// A gravity beyond doubt not the Earth's in a scene with the Earth's: what is named so is something that acts like it.
std::string doubt_of(const Diagnosis& d, const NamedEffect& effect) {
  const double stated = d.used.gravity.norm();
  if (effect.candidate->name != "retune_gravity" || stated < LEAST_ON_EARTH || stated > MOST_ON_EARTH) return "";
  const NamedParameter& found = effect.parameters.at(0);
  if (found.high >= LEAST_ON_EARTH && found.low <= MOST_ON_EARTH) return "";
  return ", which is nowhere on Earth (" + shown(LEAST_ON_EARTH) + " to " + shown(MOST_ON_EARTH) +
         "): on level ground it stands for a constant force, or for lengths or times that are recorded wrong";
}

json parameters_of(const NamedEffect& effect) {
  json all = json::object();
  for (const NamedParameter& p : effect.parameters)
    all[p.name] = {{"value", p.value}, {"low", p.low}, {"high", p.high}, {"unit", p.unit}};
  return all;
}

json ranking_of(const Diagnosis& diagnosis) {
  json list = json::array();
  for (const RankedModel& model : diagnosis.ranking) {
    json one;
    std::string name, target;
    for (const Candidate* part : model.parts) {
      name += (name.empty() ? "" : " + ") + part->name;
      target += (target.empty() ? "" : " + ") + part->target;
    }
    one["name"] = name;
    one["target"] = target;
    if (model.fails_held_out) one["fails_held_out"] = true;
    one["held_out_error"] = model.error;  // of left-out fitting runs, in units of noise
    one["evidence"] = model.evidence;
    one["probability"] = model.probability;
    std::size_t at = 0;
    for (const Candidate* part : model.parts)
      for (const Parameter& p : part->parameters) {
        one["parameters"][part->name + "." + p.name] = model.values[at];
        if (std::isfinite(model.deviations[at])) one["deviations"][part->name + "." + p.name] = model.deviations[at];
        ++at;
      }
    list.push_back(std::move(one));
  }
  return list;
}

json could_show(const Diagnosis& d) {
  json list = json::array();
  for (const Showable& row : d.showable) {
    json one = {{"name", row.candidate->name}, {"target", row.candidate->target},
                {"parameter", row.parameter},  {"unit", row.unit},
                {"sigma", row.sigma},          {"smallest", row.smallest}};
    if (row.look_alike != nullptr) {
      one["look_alike"] = row.look_alike->label();
      one["sigma_beside"] = std::isfinite(row.sigma_beside) ? json(row.sigma_beside) : json(nullptr);
    }
    list.push_back(std::move(one));
  }
  return list;
}

json effects_of(const Diagnosis& d) {
  json list = json::array();
  if (d.verdict == Verdict::none || d.verdict == Verdict::agrees) return list;
  for (const NamedEffect& e : d.effects)
    list.push_back({{"name", e.candidate->name},
                    {"family", family_name(e.candidate->family)},
                    {"site", e.candidate->site},
                    {"law", e.candidate->law},
                    {"target", e.candidate->target},
                    {"parameters", parameters_of(e)}});
  return list;
}

json adjusted_of(const Diagnosis& d) {
  json list = json::array();
  for (const AdjustedNumber& number : d.adjusted)
    list.push_back({{"name", number.name},
                    {"target", number.target},
                    {"unit", number.unit},
                    {"stated", number.stated},
                    {"sigma", number.sigma},
                    {"value", number.value},
                    {"deviation", number.deviation}});
  return list;
}

json where_of(const Diagnosis& d) {
  json list = json::array();
  for (const Cell& cell : d.where)
    list.push_back({{"body", cell.body},
                    {"phase", cell.phase},
                    {"share", cell.share},
                    {"onset_s", cell.onset >= 0 ? json(cell.onset) : json(nullptr)},
                    {"rms_in_noise", cell.rms},
                    {"p_value", cell.p_value},
                    {"significant", cell.is_significant}});
  return list;
}

json held_out_of(const Diagnosis& d) {
  json held_out = {
      {"before", d.before}, {"after", d.after}, {"floor", d.floor}, {"unit", d.unit}, {"gap_closed", d.gap_closed}};
  const WholeRuns& whole = d.whole;
  if (whole.is_judged())
    held_out["whole_runs"] = {{"before", whole.before},
                              {"after", whole.after},
                              {"floor", whole.floor},
                              {"unit", d.unit},
                              {"gap_closed", closed(whole.before, whole.after, whole.floor)}};
  else
    held_out["whole_runs"] = {{"not_judged", whole.why_not}};
  if (std::isfinite(d.mask_gap_before))
    held_out["mask_gap"] = {{"before", d.mask_gap_before}, {"after", d.mask_gap_after}, {"unit", "1 - mIoU"}};
  return held_out;
}

json regressed_of(const RegressedLaw& law, const std::string& unit) {
  return {{"effect", law.effect},
          {"target", law.target},
          {"formula", law.amended.formulas},
          {"coefficients", law.amended.parameters},
          {"unit", law.unit},
          {"held_out",
           {{"before", law.before},
            {"after", law.after},
            {"floor", law.floor},
            {"unit", unit},
            {"gap_closed", law.gap_closed}}},
          {"fit_after", law.error}};
}

json report_of(const Problem& problem, const Diagnosis& d) {
  json report = {{"schema", 1}, {"verdict", verdict_name(d.verdict)}, {"sentence", d.sentence}};
  report["effects"] = effects_of(d);
  report["adjusted"] = adjusted_of(d);
  report["ranking"] = ranking_of(d);
  report["inseparable"] = d.inseparable;
  report["next_experiment"] = d.next_experiment;
  if (d.next_motion) {
    report["next_scene"] = "next_experiment.yaml";
    report["next_run"] = json::parse(next_run(problem, *d.next_motion));
  }
  report["where"] = where_of(d);
  report["held_out"] = held_out_of(d);
  if (d.regressed) report["regressed"] = regressed_of(*d.regressed, d.unit);
  report["fit"] = {{"before", d.fit_before}, {"after", d.fit_after}, {"unit", "noise"}};
  report["notes"] = d.notes;
  report["left_out"] = d.left_out;
  report["could_show"] = could_show(d);
  report["amended_scene"] = "scene_amended.yaml";
  report["seconds"] = d.seconds;
  report["simulations"] = d.simulations;
  return report;
}

}  // namespace

std::string shown(double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%.3g", value);
  return text;
}

std::string text_of(const RegressedLaw& law) {
  const std::string what = effect_kind(law.effect).target == EffectTarget::joint ? "effort at " : "force on ";
  return what + law.target + " = " + law.shown + " " + law.unit;
}

namespace {

// ", of whole runs from 40 to 3.1 mrad"
std::string whole_runs_text(const Diagnosis& d, const std::string& unit) {
  if (d.floor == 0 || !d.whole.is_judged()) return "";
  if (d.whole.before == d.before && d.whole.after == d.after) return "";
  return ", of whole runs from " + shown(d.whole.before) + " to " + shown(d.whole.after) + unit;
}

std::string sentence_of(const Diagnosis& d, Verdict verdict) {
  const std::string unit = d.unit == "noise" ? " times the noise" : " " + d.unit;
  std::string judged = d.floor > 0
                           ? std::string("the held-out error ") + (d.after < d.before ? "falls" : "rises") + " from " +
                                 shown(d.before) + " to " + shown(d.after) + unit + ", noise floor " + shown(d.floor)
                       : d.whole.why_not.empty() ? "no run was held out to prove it on"
                                                 : d.whole.why_not;
  if (d.floor > 0 && std::isfinite(d.mask_gap_before))
    judged += "; the masks' gap, 1 - mIoU, from " + shown(d.mask_gap_before) + " to " + shown(d.mask_gap_after);
  if (verdict == Verdict::agrees)
    return "simulation and measurement agree within the noise: the error is " + shown(d.fit_before) +
           " times the noise";
  if (verdict == Verdict::none && !std::isfinite(d.fit_before))
    return "nothing was compared: the scene is too slow to be simulated in the time given by --minutes";
  if (verdict == Verdict::none && !d.undecided.empty())
    return d.undecided + "; the error is " + shown(d.fit_before) + " times the noise";
  if (verdict == Verdict::none) {
    // what was cut short proves nothing about the effects that were not looked at
    std::string text = (d.left_out.empty() ? "none of the known effects explains the misfit of "
                                           : "in the time given no effect was found that explains the misfit of ") +
                       shown(d.fit_before) + " times the noise";
    if (!d.where.empty()) text += ", most of which is of " + d.where[0].body + " (" + d.where[0].phase + ")";
    if (d.floor > 0 && d.before < criteria().agrees_rms * d.floor) {
      text += "; the held-out runs agree with the scene as it stands: their error is " + shown(d.before) + unit +
              ", noise floor " + shown(d.floor);
    } else if (!d.effects.empty()) {
      text += "; best, but not enough: ";
      for (std::size_t i = 0; i < d.effects.size(); ++i) text += (i ? " and " : "") + d.effects[i].candidate->label();
      text += ", " + judged + whole_runs_text(d, unit);
    }
    if (d.regressed)
      text += "; a law without a name is in the amended scene: " + text_of(*d.regressed) +
              ", with it the held-out error is " + shown(d.regressed->after) + unit + " (without " +
              shown(d.regressed->before) + ", noise floor " + shown(d.regressed->floor) + ")";
    if (!d.left_out.empty()) text += "; left out: " + d.left_out.front();
    return text;
  }
  judged += whole_runs_text(d, unit);
  std::string what;
  for (const NamedEffect& e : d.effects) {
    const char* word = e.candidate->family == Family::physical    ? "missing: "
                       : e.candidate->family == Family::parameter ? "wrong in the scene: "
                                                                  : "of the measurement: ";
    std::string values;
    for (const NamedParameter& p : e.parameters) values += (values.empty() ? "" : ", ") + with_interval(p);
    what += (what.empty() ? "" : "; ") + std::string(word) + e.candidate->label() + ", " + values +
            alternatives_of(d, e.candidate->label()) + doubt_of(d, e);
  }
  std::string text = what + "; " + judged;
  if (d.floor > 0 && d.after > criteria().explained_held_out * d.floor)
    text += "; partly explained: " + shown(d.after / d.floor) + " times the noise is left";
  return text;
}

// How the noise of each channel is known: given, measured, of repeats (of runs with the same commands) or assumed.
json noise_of(const Problem& problem) {
  json list = json::array();
  for (const Channel& channel : problem.channels)
    list.push_back({{"channel", channel.name},
                    {"sigma", channel.sigma},
                    {"least", channel.least_sigma > 0 ? channel.least_sigma : channel.sigma},
                    {"unit", channel.unit},
                    {"source", channel.is_noise_known        ? "given"
                               : channel.is_noise_assumed    ? "assumed"
                               : channel.is_noise_of_repeats ? "repeats"
                                                             : "measured"}});
  return list;
}

}  // namespace

std::string sentence_of(const Diagnosis& d) {
  if (d.supposed_noise.empty()) return sentence_of(d, d.verdict);
  return d.supposed_noise + ": " + sentence_of(d, d.supposed_verdict);
}

void write_report(const Problem& problem, Diagnosis& diagnosis, const std::filesystem::path& folder) {
  diagnosis.sentence = sentence_of(diagnosis);
  write_text_atomically(folder / "scene_amended.yaml", amended_scene(problem, diagnosis, folder));
  if (diagnosis.next_motion)
    write_text_atomically(folder / "next_experiment.yaml", next_scene(problem, diagnosis, folder));
  write_text_atomically(folder / "report.html", html_of(problem, diagnosis));
  json report = report_of(problem, diagnosis);
  report["noise"] = noise_of(problem);
  if (!diagnosis.supposed_noise.empty()) report["supposed_noise"] = diagnosis.supposed_noise;
  write_text_atomically(folder / "report.json", report.dump(2) + "\n");
}

}  // namespace pvg::diagnose
