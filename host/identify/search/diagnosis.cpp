#include "host/identify/search/diagnosis.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "host/base/counted.hpp"
#include "host/identify/criteria.hpp"
#include "host/identify/data/noise.hpp"
#include "host/identify/fit/agreement.hpp"
#include "host/identify/fit/choose_windows.hpp"
#include "host/identify/fit/limits.hpp"
#include "host/identify/fit/whole_runs.hpp"
#include "host/identify/search/measure.hpp"
#include "host/identify/search/prove.hpp"
#include "host/identify/search/regress.hpp"
#include "host/identify/search/screening.hpp"
#include "host/identify/search/workflow.hpp"
#include "host/identify/sensing/journal.hpp"
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

// Where the simulated results of this diagnosis are kept, so that a stopped one goes on. A question that depends on
// other settings, or another device, has another key.
Journal open_journal(Workflow& flow, const Device& device) {
  const Settings& settings = flow.settings;
  Journal journal(
      flow.files.folder / "simulated.bin",
      journal_key(flow.problem, std::to_string(settings.max_effects) + std::to_string(int(settings.decide)) +
                                    (settings.halves_step ? "half" : "") + device.info().name));
  if (!settings.simulates) journal.set_read_only();
  return journal;
}

// The scene as it stands agrees with the fitted runs: what they could have shown, and whether held-out runs agree too.
// Returns the numbers with a prior as they fit.
Model conclude_agreement(Workflow& flow, const ChosenWindows& chosen, Diagnosis& out) {
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
  Model nuisances = proof.nuisances;
  out.undecided = doubt_of(flow.problem, proof.held_out);
  if (!out.undecided.empty()) out.verdict = Verdict::none;
  add_proof(out, std::move(proof));
  return nuisances;
}

// Stages 4 to 6. Where the first effect asks for a finer time step, windows and search are repeated with it.
Selection select_effects(Workflow& flow, ChosenWindows& chosen, Diagnosis& out) {
  flow.report_progress(4, 0.25, "screening " + counted(out.candidates->size(), "candidate"));
  Selection selected = forward_selection(flow, *out.candidates, chosen);
  if (!selected.asks_for_new_step) return selected;
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
  return forward_selection(flow, *out.candidates, chosen, selected.ends);
}

// Looks for a law without a name where what is named leaves much. False where that law explains what the name only
// imitates.
bool withstands_laws(Workflow& flow, const ChosenWindows& chosen, const std::vector<Cell>& where, bool is_proved,
                     Diagnosis& out) {
  std::optional<Regressed> found = find_law(flow, chosen, where, out.unit);
  if (found && is_proved && !is_imitation(out, found->law)) found.reset();
  if (!found) return true;
  if (is_proved)
    flow.notes.push_back(
        fmt::format("{} leaves {:.3g} times the noise in held-out runs, a law without a name {:.3g} times: the "
                    "name is withheld",
                    out.effects.back().candidate->label(), out.after / out.floor, found->law.after / out.floor));
  out.regressed = std::move(found->law);
  out.curves = std::move(found->curves);
  return false;
}

void note_bounds(Workflow& flow, bool is_at_bound, const std::string& better_at_bound, const Diagnosis& out) {
  if (is_at_bound)
    flow.notes.push_back(
        "a number of the best model ended at its bound: it was not measured, and the model passes no proof");
  if (!better_at_bound.empty() && !out.effects.empty())
    flow.notes.push_back(
        fmt::format("{} explains as much and is more probable than {}, but a number of it ended at its bound: neither "
                    "was measured, and the name is withheld",
                    better_at_bound, out.effects.back().candidate->label()));
}

// Stage 7: what was selected, judged on the held-out runs. Returns the numbers with a prior as they fit beside it.
Model conclude_search(Workflow& flow, const ChosenWindows& chosen, Selection selected, Located located,
                      Diagnosis& out) {
  const bool is_workflow = flow.settings.decide == Decide::workflow;
  flow.report_progress(7, 0.9, "judging on the held-out runs");
  Proof proof = prove(flow, chosen, std::move(selected), out.unit);
  Model nuisances = proof.nuisances;
  out.used.solver.time_step = flow.base.scene.solver.time_step;
  const std::string better_at_bound = proof.selected.better_at_bound;
  const bool is_at_bound = proof.is_at_bound && is_workflow;
  const bool is_enough = closes_enough(proof.held_out), follows = proof.selected.follows;
  add_proof(out, std::move(proof));
  const bool is_judged = out.floor > 0;
  note_bounds(flow, is_at_bound, better_at_bound, out);
  bool is_proved = !out.effects.empty() && !is_at_bound && better_at_bound.empty();
  if (is_workflow) is_proved = is_proved && is_enough && follows && out.holds_on_whole_runs;
  const bool leaves_much = !is_proved || out.after > criteria().unexplained * out.floor;
  if (leaves_much && follows && is_judged && is_workflow)
    is_proved = withstands_laws(flow, chosen, located.where, is_proved, out) && is_proved;
  out.verdict = is_proved ? verdict_of(out.effects) : Verdict::none;
  if (!is_proved && is_judged && !out.effects.empty()) out.ranking.front().fails_held_out = true;
  out.where = std::move(located.where);
  out.supposed_verdict = out.verdict;
  if (!out.supposed_noise.empty()) out.verdict = Verdict::none;
  return nuisances;
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
    journal = open_journal(flow, device);
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
    nuisances = conclude_agreement(flow, chosen, out);
  } else {
    Located located = locate(flow, chosen);
    out.candidates = std::make_shared<std::vector<Candidate>>(all_candidates(flow, chosen, located));
    Selection selected = select_effects(flow, chosen, out);
    nuisances = conclude_search(flow, chosen, std::move(selected), std::move(located), out);
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
