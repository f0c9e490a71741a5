#include "host/identify/search/diagnosis.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <set>

#include "host/identify/criteria.hpp"
#include "host/identify/data/noise.hpp"
#include "host/identify/fit/agreement.hpp"
#include "host/identify/fit/choose_windows.hpp"
#include "host/identify/fit/far_number.hpp"
#include "host/identify/fit/limits.hpp"
#include "host/identify/fit/time_step.hpp"
#include "host/identify/fit/whole_runs.hpp"
#include "host/identify/search/prove.hpp"
#include "host/identify/search/regress.hpp"
#include "host/identify/search/screening.hpp"
#include "host/identify/search/workflow.hpp"
#include "host/identify/sensing/journal.hpp"
#include "host/identify/sensing/video_sight.hpp"
#include "host/identify/sensing/world.hpp"

namespace pvg::diagnose {
namespace {

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
    const auto found = flow.fitter.evaluate(windows, {fit.model}, {fit.delta}, true);
    for (const Prediction& p : found.front()) {
      phases.push_back(p.phase);
      touching.insert(p.touching.begin(), p.touching.end());
    }
    return localise(flow.problem, windows.windows, fit.residual, phases);
  };
  std::vector<Cell> found = where(chosen.data, chosen.base);
  if (flow.problem.can_restart && chosen.length != criteria().locate_window) {
    const FitData near = flow.fitter.prepare(
        make_windows(flow.problem, false, criteria().locate_window, criteria().n_windows_most), chosen.base.model);
    if (!near.windows.empty()) {
      const std::vector<Cell> cells = where(near, flow.fitter.fit(near, {chosen.base.model}, 0).front());
      if (any_significant(cells)) found = cells;
    }
  }
  return {std::move(found), {touching.begin(), touching.end()}};
}

// From here on the numbers that are known with a standard deviation are free, in every model. Where there is no time,
// or they cannot be fitted, they remain as stated.
void free_nuisances(Workflow& flow, ChosenWindows& chosen) {
  if (flow.nuisances.empty() || chosen.data.windows.empty()) return;
  std::vector<const Candidate*> parts;
  for (const Candidate& nuisance : flow.nuisances) parts.push_back(&nuisance);
  const Model before = flow.fitter.as_it_stands();
  if (before.parts.empty()) flow.fitter.stand_at(chosen.data.at = model_of(parts));
  const bool is_in_time =
      flow.ends_in_time(criteria().time_localisation, "other values of numbers that have a prior", [&] {
        if (Fit fit = fit_as_it_stands(flow.fitter, chosen.data); fit.succeeded) chosen.base = std::move(fit);
      });
  if (!is_in_time && before.parts.empty()) chosen.data.at = before;
  flow.fitter.stand_at(is_in_time ? chosen.base.model : before);
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

Verdict verdict_of(const std::vector<NamedEffect>& effects) {
  bool any_physical = false, any_parameter = false;
  for (const NamedEffect& e : effects) {
    any_physical = any_physical || e.candidate->family == Family::physical;
    any_parameter = any_parameter || e.candidate->family == Family::parameter;
  }
  return any_physical ? Verdict::effect : any_parameter ? Verdict::retune : Verdict::measurement;
}

// The scene with the number that is wrong by factors, if there is one. It is looked for in steps of second order.
std::optional<Variant> nearer_scene(Workflow& flow) {
  SolverSettings& solver = flow.base.scene.solver;
  const SolverSettings as_given = solver;
  solver.integrator = SolverSettings::Integrator::bdf2;
  const std::optional<FarNumber> far = find_far_number(flow.fitter, flow.problem);
  solver = as_given;
  if (!far) return std::nullopt;
  flow.notes.push_back(fmt::format(
      "{} at {} of {:.3g} {} instead of {:.3g} alone leaves {:.3g} of {:.3g} times the noise: the time step is "
      "chosen for it, and all candidates are tried",
      far->number.name, far->number.target, far->value, far->number.parameters[0].unit, far->number.parameters[0].off,
      far->after, far->before));
  Model model = model_of({&far->number});
  model.x[0] = far->value;
  return variant_of(flow.base, model);
}

// The scene's own step where there is no time to compare it with finer ones.
void choose_step(Workflow& flow) {
  std::string note;
  if (flow.ends_in_time(criteria().time_measurement, "the comparison with finer time steps", [&] {
        std::optional<Variant> nearer = nearer_scene(flow);
        note = choose_time_step(flow.fitter, flow.predictor, flow.problem, nearer ? *nearer : flow.base);
        if (!nearer) return;
        flow.base.scene.solver = nearer->scene.solver;
        flow.base.extrapolates = nearer->extrapolates;
      })) {
    flow.notes.push_back(note);
    return;
  }
  const SolverSettings& given = flow.problem.scene.scene.solver;
  flow.base.scene.solver.time_step = given.time_step;
  flow.base.scene.solver.integrator = given.integrator;
  flow.fitter.take_steps_as_they_are();
}

// Which neo-Hookean density the soft bodies have.
std::string elasticity_sentence(const PhysicalScene& scene) {
  std::string with;
  for (const Effect& effect : scene.effects)
    if (effect.name == "neo_hookean_logarithm")
      with += fmt::format("; {} has {:g} of the logarithm", effect.target, parameter_of(effect, "share"));
  return "soft bodies are stable neo-Hookean without the logarithm (Smith, De Goes, Kim 2018): Psi = mu/2 (|F|^2 - 3) "
         "+ "
         "lambda'/2 (J - 1 - mu/lambda')^2 up to a constant; moduli of other variants differ at large strains" +
         with;
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
  if (!problem.scene.scene.soft_bodies.empty()) flow.notes.push_back(elasticity_sentence(problem.scene.scene));
  // the moments of a mask have no common size, nor have the cells of a picture
  const bool has_pictures = !problem.recording.mask_sources.empty() || !problem.recording.video_sources.empty();
  flow.report_progress(1, 0,
                       "noise of " + std::to_string(problem.channels.size()) + " channels, " +
                           std::to_string(problem.runs.size()) + " runs");
  choose_step(flow);
  if (flow.settings.halves_step) {
    flow.base.scene.solver.time_step /= 2;
    flow.notes.push_back(
        fmt::format("half that step, as asked for: {:.4g} ms", 1e3 * flow.base.scene.solver.time_step));
  }
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
  free_nuisances(flow, chosen);
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
  if (flow.is_costly()) order_by_place(flow.problem, where, candidates);
  flow.report_progress(3, 0.2,
                       where.empty() ? "nothing located"
                                     : where[0].body + ", " + where[0].phase + ": " +
                                           std::to_string(int(100 * where[0].share)) + " % of the misfit");
  return candidates;
}

void add_proof(Diagnosis& out, Proof proof) {
  out.effects = std::move(proof.effects);
  out.adjusted = std::move(proof.adjusted);
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

// Whether what is named only imitates what has no name: it leaves more than noise, of which the law explains most.
bool is_imitation(const Diagnosis& named, const RegressedLaw& law) {
  return closed(named.after, law.after, named.floor) >= criteria().gap_closed_least;
}

// What the data make of the numbers with a prior holds in all that is written. A scene that explains nothing tells
// nothing of them.
void keep_adjusted(Workflow& flow, const Model& nuisances, Diagnosis& out) {
  flow.base = variant_of(flow.base, nuisances);
  if (out.verdict == Verdict::none) out.adjusted.clear();
  if (!out.adjusted.empty()) out.used = variant_of({out.used, {}}, nuisances).scene;
  for (const AdjustedNumber& number : out.adjusted)
    flow.notes.push_back(fmt::format("{} at {}, {:.4g} +- {:.2g} {} before any data: {:.4g} +- {:.2g} {} fits best",
                                     number.name, number.target, number.stated, number.sigma, number.unit, number.value,
                                     number.deviation, number.unit));
}

}  // namespace

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
                                               (settings.halves_step ? "half" : "") + device.info().name));
    if (!settings.simulates) journal.set_read_only();
    flow.predictor.keep_in(&journal);
  }
  out.unit = measure(flow);
  out.used = flow.base.scene;
  out.is_extrapolated = flow.base.extrapolates;
  ChosenWindows chosen = find_residual(flow, criteria().time_residual);
  bool is_fine = !chosen.data.windows.empty() && agrees(flow, chosen);
  if (is_fine) out.supposed_noise = suppose_less_noise(problem, rms(chosen.base.residual));
  if (!out.supposed_noise.empty()) {  // what would be named with less noise
    chosen = find_residual(flow, criteria().time_search);
    is_fine = !chosen.data.windows.empty() && agrees(flow, chosen);
  }
  Model nuisances;
  out.fit_before = chosen.data.windows.empty() ? NAN : rms(chosen.base.residual);
  if (chosen.data.windows.empty()) {
    out.verdict = Verdict::none;
  } else if (is_fine) {
    out.verdict = Verdict::agrees;
    flow.ends_in_time(criteria().time_localisation, "what these recordings could have shown", [&] {
      *out.candidates = all_candidates(flow, chosen, locate(flow, chosen));
      std::vector<const Candidate*> all;
      for (const Candidate& candidate : *out.candidates) all.push_back(&candidate);
      const Screening screening(flow, chosen.data, chosen.base);
      flow.show(identifiability(signatures_of(screening.fitter, screening.data, chosen.base, all)));
    });
    Selection nothing;
    nothing.error = out.fit_before;
    Proof proof = prove(flow, chosen, std::move(nothing), out.unit);
    nuisances = proof.nuisances;
    out.undecided = doubt_of(problem, proof.held_out);
    if (!out.undecided.empty()) out.verdict = Verdict::none;
    add_proof(out, std::move(proof));
  } else {
    Located located = locate(flow, chosen);
    out.candidates = std::make_shared<std::vector<Candidate>>(all_candidates(flow, chosen, located));
    flow.report_progress(4, 0.25, "screening " + std::to_string(out.candidates->size()) + " candidates");
    Selection selected = forward_selection(flow, *out.candidates, chosen);
    if (selected.asks_for_new_step) {
      flow.report_progress(2, 0.3, "again with a finer time step");
      if (ChosenWindows again = find_residual(flow, criteria().time_search); !again.data.windows.empty()) {
        chosen = std::move(again);
        out.fit_before = rms(chosen.base.residual);
        out.used = flow.base.scene;
        out.is_extrapolated = flow.base.extrapolates;
      } else {
        flow.base.scene.solver = out.used.solver;
        flow.base.extrapolates = out.is_extrapolated;
      }
      const std::vector<Model> ends = std::move(selected.ends);
      selected = forward_selection(flow, *out.candidates, chosen, ends);
    }
    flow.report_progress(7, 0.9, "judging on the held-out runs");
    Proof proof = prove(flow, chosen, std::move(selected), out.unit);
    nuisances = proof.nuisances;
    out.used.solver.time_step = flow.base.scene.solver.time_step;
    const std::string better_at_bound = proof.selected.better_at_bound;
    const bool is_at_bound = proof.is_at_bound && settings.decide == Decide::workflow;
    const bool is_enough = closes_enough(proof.held_out), follows = proof.selected.follows;
    add_proof(out, std::move(proof));
    const bool is_judged = out.floor > 0;
    if (is_at_bound)
      flow.notes.push_back(
          "a number of the best model ended at its bound: it was not measured, and the model passes no proof");
    if (!better_at_bound.empty() && !out.effects.empty())
      flow.notes.push_back(fmt::format(
          "{} explains as much and is more probable than {}, but a number of it ended at its bound: neither "
          "was measured, and the name is withheld",
          better_at_bound, out.effects.back().candidate->label()));
    bool is_proved = !out.effects.empty() && !is_at_bound && better_at_bound.empty();
    if (settings.decide == Decide::workflow) is_proved = is_proved && is_enough && follows && out.holds_on_whole_runs;
    const bool leaves_much = !is_proved || out.after > criteria().unexplained * out.floor;
    if (leaves_much && follows && is_judged && settings.decide == Decide::workflow) {
      std::optional<Regressed> found = find_law(flow, chosen, located.where, out.unit);
      if (found && is_proved && !is_imitation(out, found->law)) found.reset();
      if (found && is_proved) {
        flow.notes.push_back(
            fmt::format("{} leaves {:.3g} times the noise in held-out runs, a law without a name {:.3g} times: the "
                        "name is withheld",
                        out.effects.back().candidate->label(), out.after / out.floor, found->law.after / out.floor));
        is_proved = false;
      }
      if (found) {
        out.regressed = std::move(found->law);
        out.curves = std::move(found->curves);
      }
    }
    out.verdict = is_proved ? verdict_of(out.effects) : Verdict::none;
    if (!is_proved && is_judged && !out.effects.empty()) out.ranking.front().fails_held_out = true;
    out.where = std::move(located.where);
    out.supposed_verdict = out.verdict;
    if (!out.supposed_noise.empty()) out.verdict = Verdict::none;
  }
  keep_adjusted(flow, nuisances, out);
  out.base = std::move(flow.base);
  out.seconds = flow.seconds();
  out.simulations = flow.predictor.n_simulations();
  out.notes = std::move(flow.notes);
  out.showable = std::move(flow.showable);
  out.left_out = std::move(flow.left_out);
  if (!settings.keeps_simulations) journal.remove();
  return out;
}

}  // namespace pvg::diagnose
