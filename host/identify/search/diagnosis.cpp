#include "host/identify/search/diagnosis.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <set>

#include "host/base/error.hpp"
#include "host/identify/criteria.hpp"
#include "host/identify/data/noise.hpp"
#include "host/identify/fit/agreement.hpp"
#include "host/identify/fit/limits.hpp"
#include "host/identify/fit/time_step.hpp"
#include "host/identify/fit/whole_runs.hpp"
#include "host/identify/search/choose_windows.hpp"
#include "host/identify/search/next_experiment.hpp"
#include "host/identify/search/regress.hpp"
#include "host/identify/search/workflow.hpp"
#include "host/identify/sensing/journal.hpp"
#include "host/identify/sensing/video_sight.hpp"

namespace pvg::diagnose {
namespace {

using Eigen::VectorXd;
constexpr double UNMOVED = 1e-6;  // of its standard deviation: nothing is sensitive to it

Model empty_model() { return {{}, VectorXd(), VectorXd()}; }

bool any_significant(const std::vector<Cell>& cells) {
  return std::any_of(cells.begin(), cells.end(), [](const Cell& cell) { return cell.is_significant; });
}

struct Located {
  std::vector<Cell> where;
  std::vector<std::string> touching;  // pairs of bodies
};

// The cells of the misfit, and the bodies that touch. Cells are of short windows; of those of the fit if none of the
// short ones is significant.
Located find_where(Workflow& flow, const ChosenWindows& chosen) {
  std::set<std::string> touching;
  const auto where = [&](const FitData& windows, const Fit& fit) {
    std::vector<std::vector<Phase>> phases;
    const auto found = flow.fitter.evaluate(windows, {empty_model()}, {fit.delta}, true);
    for (const Prediction& p : found.front()) {
      phases.push_back(p.phase);
      touching.insert(p.touching.begin(), p.touching.end());
    }
    return localise(flow.problem, windows.windows, fit.residual, phases);
  };
  std::vector<Cell> found = where(chosen.data, chosen.base);
  if (flow.problem.can_restart && chosen.length != criteria().locate_window) {
    const FitData near = flow.fitter.prepare(
        make_windows(flow.problem, false, criteria().locate_window, criteria().n_windows_most), empty_model());
    if (!near.windows.empty()) {
      const std::vector<Cell> cells = where(near, flow.fitter.fit(near, {empty_model()}, 0).front());
      if (any_significant(cells)) found = cells;
    }
  }
  return {std::move(found), {touching.begin(), touching.end()}};
}

// Whether the scene as it stands leaves noise alone. Starts that are fitted anew in each short window take up a slow
// drift: whole runs, where they can be simulated, have to agree too; else they are the windows from then on.
bool agrees(Workflow& flow, ChosenWindows& chosen) {
  const Agreement by_windows = agreement_of(flow.problem, chosen.data.windows, chosen.base.residual);
  if (!by_windows.is_agreement) {
    flow.notes.push_back("misfit: " + text_of(by_windows));
    return false;
  }
  std::optional<ChosenWindows> whole;
  if (chosen.length > 0)
    flow.ends_in_time(criteria().time_localisation, "agreement over whole runs",
                      [&] { whole = choose_whole_runs(flow.fitter, flow.problem, flow.settings.simulated_seconds); });
  if (!whole) return true;
  const Agreement by_runs = agreement_of(flow.problem, whole->data.windows, whole->base.residual);
  if (by_runs.is_agreement) return true;
  flow.notes.push_back("short windows agree, whole runs do not: " + text_of(by_runs) + "; judged on whole runs");
  chosen = std::move(*whole);
  return false;
}

// Why a scene that the fitting runs do not contradict still cannot be said to agree; empty: it agrees.
std::string doubt_of(const Problem& problem, const HeldOut& held_out) {
  if (any_noise_is_assumed(problem))
    return "whether simulation and measurement agree is not known: the noise of a channel is neither given nor could "
           "it be measured; give `noise`";
  if (held_out.floor > 0 && !held_out.agreement.is_agreement)
    return "the fitted runs agree with the scene, the held-out ones do not: " + text_of(held_out.agreement);
  return "";
}

std::vector<NamedEffect> named_of(const Fit& fit) {
  std::vector<NamedEffect> named;
  Eigen::Index at = 0;
  for (const Candidate* part : fit.model.parts) {
    NamedEffect effect{part, {}};
    for (const Parameter& p : part->parameters) {
      const double sigma = std::sqrt(std::max(fit.covariance(at, at), 0.0)), found = fit.model.x[at++];
      const double x = std::abs(found - p.off) < UNMOVED * sigma ? p.off : found;
      effect.parameters.push_back({p.name, p.unit, x, std::max(x - 2 * sigma, p.low), std::min(x + 2 * sigma, p.high)});
    }
    named.push_back(std::move(effect));
  }
  return named;
}

Verdict verdict_of(const std::vector<NamedEffect>& effects) {
  bool any_physical = false, any_parameter = false;
  for (const NamedEffect& e : effects) {
    any_physical = any_physical || e.candidate->family == Family::physical;
    any_parameter = any_parameter || e.candidate->family == Family::parameter;
  }
  return any_physical ? Verdict::effect : any_parameter ? Verdict::retune : Verdict::measurement;
}

// Stage 7: the effects that the held-out runs confirm, and the curves. Without a held-out run the floor is 0.
struct Proof {
  Selection selected;  // without the effects that proved nothing
  std::vector<NamedEffect> effects;
  HeldOut held_out;
  WholeRuns whole;
  std::vector<Curve> curves;
  bool is_at_bound = false;  // a number of what was named ended there
};

// The named model on whole held-out runs. Where the windows are whole runs already they have shown it.
WholeRuns prove_on_whole_runs(Workflow& flow, const ChosenWindows& chosen, const HeldOut& judged, const Model& named,
                              bool in_noise) {
  WholeRuns whole;
  if (judged.floor == 0) {
    whole.why_not = "the held-out runs were not judged";
    return whole;
  }
  if (chosen.length == 0) {
    whole.before = judged.before, whole.after = judged.after, whole.floor = judged.floor;
    return whole;
  }
  whole.why_not = "there was no time";
  whole.had_no_time = true;
  flow.ends_in_time(criteria().time_proof, "the proof on whole runs", [&] {
    whole = judge_whole_runs(flow.fitter, flow.problem, criteria().whole_run_proof, named, in_noise, judged.disturbed);
  });
  return whole;
}

// A sentence on them; unit: of the errors.
std::string text_of(const WholeRuns& whole, const std::string& unit) {
  if (!whole.is_judged()) return "the held-out runs were judged by windows alone, not whole: " + whole.why_not;
  return fmt::format(
      "held-out runs simulated whole from their first state: error {:.3g} before and {:.3g} after, {}; "
      "errors of their starts grow to {:.2g} times the noise",
      whole.before, whole.after, unit == "noise" ? "times the noise" : unit, whole.growth);
}

Proof prove(Workflow& flow, const ChosenWindows& chosen, Selection selected, const std::string& unit) {
  const Problem& problem = flow.problem;
  std::vector<Model> models;
  for (const Fit& fit : selected.fits) models.push_back(fit.model);
  const std::size_t most = most_windows(problem, flow.settings.simulated_seconds, chosen.length);
  HeldOut judged;
  const bool is_done = flow.ends_in_time(criteria().time_proof, "the proof on held-out runs", [&] {
    judged = judge_held_out(flow.fitter, problem, chosen.length, most, models, unit == "noise");
  });
  if (!is_done) judged.kept = models.size();
  const std::size_t left = std::max<std::size_t>(judged.kept, 1);
  const bool any_selected = !selected.fits.empty();
  const Fit& named = selected.fits.empty() ? chosen.base : selected.fits[left - 1];
  if (left < selected.fits.size()) {  // the others proved nothing: behind what is named they are a hint
    const auto first = selected.ranking.begin(), named_one = first + std::ptrdiff_t(selected.fits.size() - left);
    std::for_each(first, named_one, [](RankedModel& model) { model.fails_held_out = true; });
    std::rotate(first, named_one, named_one + 1);
    selected.inseparable.resize(std::min(selected.inseparable.size(), left));
    selected.error = selected.ranking.front().error;
  }
  const bool any_held_out =
      std::any_of(problem.runs.begin(), problem.runs.end(), [](const Run& r) { return r.is_held_out; });
  if (any_held_out && is_done && judged.floor == 0)
    flow.notes.push_back("the held-out runs could not be simulated to their end");
  for (const Disturbance& d : judged.disturbed) {
    char text[300];
    std::snprintf(text, sizeof text,
                  "held-out run %s, %.2f to %.2f s: wrong by %.3g times the noise before and %.3g after, which nothing "
                  "here explains (was it pushed?); left out of the held-out errors, which are %.3g and %.3g %s with it",
                  d.run.c_str(), d.start, d.end, d.before, d.after, judged.before_all, judged.after_all,
                  unit == "noise" ? "times the noise" : unit.c_str());
    flow.notes.push_back(text);
  }
  WholeRuns whole = prove_on_whole_runs(flow, chosen, judged, named.model, unit == "noise");
  if (any_held_out) flow.notes.push_back(text_of(whole, unit));
  std::vector<NamedEffect> effects = named_of(named);
  std::vector<Curve> curves = std::move(judged.curves);
  const std::vector<Curve> fitted = curves_of(problem, chosen.data, chosen.base, named, CURVES_OF_FITTED_RUNS);
  curves.insert(curves.end(), fitted.begin(), fitted.end());
  return {std::move(selected), std::move(effects), std::move(judged),
          std::move(whole),    std::move(curves),  any_selected && is_at_bound(named)};
}

// The scene's own step where there is no time to compare it with finer ones.
void choose_step(Workflow& flow) {
  std::string note;
  if (flow.ends_in_time(criteria().time_measurement, "the comparison with finer time steps",
                        [&] { note = choose_time_step(flow.fitter, flow.predictor, flow.problem, flow.base); })) {
    flow.notes.push_back(note);
    return;
  }
  const SolverSettings& given = flow.problem.scene.scene.solver;
  flow.base.scene.solver.time_step = given.time_step;
  flow.base.scene.solver.integrator = given.integrator;
  flow.fitter.take_steps_as_they_are();
}

// Stage 1: noise, time step. Returns the unit of held-out errors.
std::string measure(Workflow& flow) {
  Problem& problem = flow.problem;
  for (const Criterion& one : list_criteria())
    if (one.value != one.usual)
      flow.notes.push_back(fmt::format("criterion {}: {:g} instead of {:g}", one.name, one.value, one.usual));
  measure_noise(problem);
  if (VideoSight* video = flow.predictor.video()) add_noise_of_pictures(*video, problem);
  flow.base.scene = problem.scene.scene;
  std::set<std::string> units;
  for (const Channel& c : problem.channels) {
    char text[200];
    flow.notes.push_back(noise_sentence(c));
    units.insert(c.unit);
    for (const Run& run : problem.runs)
      if (const double noise_scale = run.noise_scale[std::size_t(&c - problem.channels.data())]; noise_scale > 1) {
        std::snprintf(text, sizeof text, "noise of the %s in run %s: %.3g %s", c.name.c_str(), run.name.c_str(),
                      c.sigma * noise_scale, c.unit.c_str());
        flow.notes.push_back(text);
      }
  }
  if (!problem.scene.scene.soft_bodies.empty())
    flow.notes.push_back(
        "soft bodies are stable neo-Hookean without the logarithm (Smith, De Goes, Kim 2018): Psi = mu/2 (|F|^2 - 3) + "
        "lambda'/2 (J - 1 - mu/lambda')^2 up to a constant; moduli of other variants differ at large strains");
  // the moments of a mask have no common size, nor have the cells of a picture
  const bool has_pictures = !problem.recording.mask_sources.empty() || !problem.recording.video_sources.empty();
  flow.report_progress(1, 0,
                       "noise of " + std::to_string(problem.channels.size()) + " channels, " +
                           std::to_string(problem.runs.size()) + " runs");
  choose_step(flow);
  flow.files.write_notes("1_measurement.json", flow.notes);
  return units.size() > 1 || has_pictures ? "noise" : *units.begin();
}

// Stage 2: windows that the model can follow, and what it leaves in them. No window: there was no time.
ChosenWindows find_residual(Workflow& flow, double deadline) {
  ChosenWindows chosen;
  // again with the fewest windows if none came to an end in time
  const std::pair<double, double> tries[] = {{deadline, flow.settings.simulated_seconds}, {criteria().time_search, 0}};
  for (const auto& [end, simulated_seconds] : tries) {
    const EarlierDeadline stage(flow.predictor.deadline(), flow.end_of(end));
    if (chosen.data.windows.empty()) chosen = choose_windows(flow.fitter, flow.problem, simulated_seconds);
  }
  if (chosen.data.windows.empty()) {
    flow.note_left_out("everything: the scene is too slow to be simulated beside the measurement");
    return chosen;
  }
  char text[200];
  std::snprintf(text, sizeof text, "%zu windows of %s; error as the scene stands %.3g times the noise",
                chosen.data.windows.size(),
                chosen.length > 0 ? (std::to_string(chosen.length).substr(0, 4) + " s").c_str() : "whole runs",
                rms(chosen.base.residual));
  flow.notes.push_back(text);
  flow.report_progress(2, 0.15, text);
  flow.files.write_notes("2_residual.json", flow.notes);
  return chosen;
}

// Stage 3: where the misfit is.
Located locate(Workflow& flow, const ChosenWindows& chosen) {
  Located located;
  flow.ends_in_time(criteria().time_localisation, "where the misfit is, and effects of contact",
                    [&] { located = find_where(flow, chosen); });
  flow.files.write_where(located.where);
  return located;
}

// All that stage 4 screens.
std::vector<Candidate> all_candidates(Workflow& flow, const ChosenWindows& chosen, const Located& located) {
  std::vector<Candidate> candidates = make_candidates(flow.problem, located.touching);
  flow.ends_in_time(criteria().time_localisation, "where limits such as a yield strain are reached",
                    [&] { place_limits(flow.fitter, chosen.data, chosen.base, candidates); });
  const std::vector<Cell>& where = located.where;
  flow.report_progress(3, 0.2,
                       where.empty() ? "nothing located"
                                     : where[0].body + ", " + where[0].phase + ": " +
                                           std::to_string(int(100 * where[0].share)) + " % of the misfit");
  return candidates;
}

void add_proof(Diagnosis& out, Proof proof) {
  out.effects = std::move(proof.effects);
  out.ranking = std::move(proof.selected.ranking);
  out.inseparable = std::move(proof.selected.inseparable);
  out.fit_after = proof.selected.error;
  out.before = proof.held_out.before;
  out.after = proof.held_out.after;
  out.floor = proof.held_out.floor;
  out.gap_closed = closed(out.before, out.after, out.floor);
  out.whole = std::move(proof.whole);
  out.holds_on_whole_runs =
      out.whole.is_judged() ? closed(out.whole.before, out.whole.after, out.whole.floor) >= criteria().gap_closed_least
                            : !out.whole.had_no_time;
  out.mask_gap_before = proof.held_out.mask_gap_before;
  out.mask_gap_after = proof.held_out.mask_gap_after;
  out.curves = std::move(proof.curves);
}

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

// Which motion would separate the names that are still confused.
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

}  // namespace

void Workflow::report_progress(int stage, double share, const std::string& text) const {
  const double since = seconds();
  std::fprintf(stderr, "diagnose %d/7: %s  (%.0f s%s)\n", stage, text.c_str(), since,
               share > 0.02 && share < 1
                   ? (", about " + std::to_string(int(since * (1 - share) / share) + 1) + " s left").c_str()
                   : "");
}

Clock::time_point Workflow::end_of(double share) const {
  return start +
         std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(60 * settings.minutes * share));
}

bool Workflow::has_time(const std::string& something, double expected_seconds, double share) {
  if (expected_seconds < seconds_until(end_of(share))) return true;
  left_out.push_back(
      fmt::format("{} was not looked for: {:.0f} s were over and it takes some {:.0f} s more; "
                  "`--minutes`, which is {:g}, gives it more",
                  something, seconds(), expected_seconds, settings.minutes));
  return false;
}

void Workflow::note_left_out(const std::string& what) {
  left_out.push_back(fmt::format("{}: left out after {:.0f} s; `--minutes`, which is {:g}, gives it more", what,
                                 seconds(), settings.minutes));
}

bool Workflow::refine_step(const Model& model) {
  if (!may_refine_step) return false;
  may_refine_step = false;
  Variant at_model = variant_of(base, model);
  std::string note;
  if (!ends_in_time(criteria().time_search, "the comparison with finer time steps at what was found",
                    [&] { note = choose_time_step(fitter, predictor, problem, at_model); }))
    return false;
  const SolverSettings& finer = at_model.scene.solver;
  SolverSettings& solver = base.scene.solver;
  if (finer.time_step >= solver.time_step && finer.integrator == solver.integrator) return false;
  solver.time_step = finer.time_step;
  solver.integrator = finer.integrator;
  notes.push_back("done again with another time step, which what was found needs: " + note);
  return true;
}

// The physical ones are printed, since these are looked for first.
void Workflow::show(std::vector<Showable> rows) {
  std::size_t n_shown = 0;
  for (const Showable& row : rows)
    if (row.candidate->family == Family::physical && n_shown++ < criteria().n_showable_printed)
      std::fprintf(stderr, "  could show %s\n", text_of(row).c_str());
  files.write_showable(rows);
  showable = std::move(rows);
}

const char* verdict_name(Verdict verdict) {
  constexpr const char* NAMES[] = {"effect", "retune", "measurement", "none", "agrees"};
  return NAMES[int(verdict)];
}

Diagnosis diagnose(Device& device, Problem& problem, const Settings& settings, const std::filesystem::path& folder) {
  Workflow flow(device, problem, settings);
  flow.files.folder = folder;
  Diagnosis out;
  out.candidates = std::make_shared<std::vector<Candidate>>();
  Journal journal;
  if (!folder.empty()) {
    journal = Journal(folder / "simulated.bin",
                      journal_key(problem, std::to_string(settings.max_effects) + std::to_string(int(settings.decide)) +
                                               device.info().name));
    if (!settings.simulates) journal.set_read_only();
    flow.predictor.keep_in(&journal);
  }
  out.unit = measure(flow);
  out.used = flow.base.scene;
  ChosenWindows chosen = find_residual(flow, criteria().time_residual);
  bool is_fine = !chosen.data.windows.empty() && agrees(flow, chosen);
  if (is_fine) out.supposed_noise = suppose_less_noise(problem, rms(chosen.base.residual));
  if (!out.supposed_noise.empty()) {  // what would be named with less noise
    chosen = find_residual(flow, criteria().time_search);
    is_fine = !chosen.data.windows.empty() && agrees(flow, chosen);
  }
  out.fit_before = chosen.data.windows.empty() ? NAN : rms(chosen.base.residual);
  if (chosen.data.windows.empty()) {
    out.verdict = Verdict::none;
  } else if (is_fine) {
    out.verdict = Verdict::agrees;
    flow.ends_in_time(criteria().time_localisation, "what these recordings could have shown", [&] {
      *out.candidates = all_candidates(flow, chosen, locate(flow, chosen));
      std::vector<const Candidate*> all;
      for (const Candidate& candidate : *out.candidates) all.push_back(&candidate);
      flow.show(identifiability(signatures_of(flow.fitter, chosen.data, chosen.base, all)));
    });
    Selection nothing;
    nothing.error = out.fit_before;
    Proof proof = prove(flow, chosen, std::move(nothing), out.unit);
    out.undecided = doubt_of(problem, proof.held_out);
    if (!out.undecided.empty()) out.verdict = Verdict::none;
    add_proof(out, std::move(proof));
  } else {
    Located located = locate(flow, chosen);
    out.candidates = std::make_shared<std::vector<Candidate>>(all_candidates(flow, chosen, located));
    flow.report_progress(4, 0.25, "screening " + std::to_string(out.candidates->size()) + " candidates");
    Selection selected = forward_selection(flow, *out.candidates, chosen.data, chosen.base);
    if (selected.asks_for_new_step) {
      flow.report_progress(2, 0.3, "again with a finer time step");
      if (ChosenWindows again = find_residual(flow, criteria().time_search); !again.data.windows.empty()) {
        chosen = std::move(again);
        out.fit_before = rms(chosen.base.residual);
        out.used = flow.base.scene;
      } else {
        flow.base.scene.solver = out.used.solver;
      }
      selected = forward_selection(flow, *out.candidates, chosen.data, chosen.base);
    }
    flow.report_progress(7, 0.9, "judging on the held-out runs");
    Proof proof = prove(flow, chosen, std::move(selected), out.unit);
    const bool is_at_bound = proof.is_at_bound && settings.decide == Decide::workflow;
    add_proof(out, std::move(proof));
    const bool is_judged = out.floor > 0;
    if (is_at_bound)
      flow.notes.push_back(
          "a number of the best model ended at its bound: it was not measured, and the model passes no proof");
    bool is_proved = !out.effects.empty() && !is_at_bound;
    if (settings.decide == Decide::workflow)
      is_proved = is_proved && is_judged && out.gap_closed >= criteria().gap_closed_least && out.after < out.before &&
                  out.holds_on_whole_runs;
    out.verdict = is_proved ? verdict_of(out.effects) : Verdict::none;
    if (!is_proved && is_judged && !out.effects.empty()) out.ranking.front().fails_held_out = true;
    if (out.verdict == Verdict::none && is_judged && settings.decide == Decide::workflow &&
        flow.has_time("a law without a name", 0, criteria().time_proof)) {
      flow.report_progress(7, 0.6, "none of the known effects: looking for a law of the motion");
      std::optional<Regressed> found;
      flow.ends_in_time(criteria().time_proof, "a law without a name",
                        [&] { found = regress(flow, chosen, located.where, out.unit == "noise"); });
      if (found) {
        out.regressed = std::move(found->law);
        out.curves = std::move(found->curves);
      }
    }
    out.where = std::move(located.where);
    out.supposed_verdict = out.verdict;
    if (!out.supposed_noise.empty()) out.verdict = Verdict::none;
  }
  plan_next(flow, device, out);
  out.seconds = flow.seconds();
  out.simulations = flow.predictor.n_simulations();
  out.notes = std::move(flow.notes);
  out.showable = std::move(flow.showable);
  out.left_out = std::move(flow.left_out);
  if (!settings.keeps_simulations) journal.remove();
  return out;
}

}  // namespace pvg::diagnose
