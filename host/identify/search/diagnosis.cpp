#include "host/identify/search/diagnosis.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <set>

#include "host/base/error.hpp"
#include "host/identify/criteria.hpp"
#include "host/identify/data/noise.hpp"
#include "host/identify/fit/limits.hpp"
#include "host/identify/fit/time_step.hpp"
#include "host/identify/search/choose_windows.hpp"
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

bool agrees(const Problem& problem, const FitData& data, const Fit& base) {
  if (rms(base.residual) > criteria().agrees_rms) return false;
  std::vector<std::vector<Phase>> one;
  for (const Window& window : data.windows) one.push_back(std::vector<Phase>(window.data.size(), Phase::free));
  for (const Cell& cell : localise(problem, data.windows, base.residual, one))
    if (cell.is_significant && cell.rms > criteria().agrees_cell_rms) return false;
  return true;
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
  std::vector<Curve> curves;
};

Proof prove(Workflow& flow, const ChosenWindows& chosen, Selection selected, const std::string& unit) {
  const Problem& problem = flow.problem;
  std::vector<Model> models;
  for (const Fit& fit : selected.fits) models.push_back(fit.model);
  const std::size_t most = most_windows(problem, flow.settings.simulated_seconds, chosen.length);
  HeldOut judged = judge_held_out(flow.fitter, problem, chosen.length, most, models, unit == "noise");
  const std::size_t left = std::max<std::size_t>(judged.kept, 1);
  const Fit& named = selected.fits.empty() ? chosen.base : selected.fits[left - 1];
  if (left < selected.fits.size()) {  // the others proved nothing
    selected.ranking.erase(selected.ranking.begin(),
                           selected.ranking.begin() + std::ptrdiff_t(selected.fits.size() - left));
    selected.inseparable.resize(std::min(selected.inseparable.size(), left));
    selected.error = selected.ranking.front().error;
  }
  const bool any_held_out =
      std::any_of(problem.runs.begin(), problem.runs.end(), [](const Run& r) { return r.is_held_out; });
  if (any_held_out && judged.floor == 0) flow.notes.push_back("the held-out runs could not be simulated to their end");
  for (const Disturbance& d : judged.disturbed) {
    char text[300];
    std::snprintf(text, sizeof text,
                  "held-out run %s, %.2f to %.2f s: wrong by %.3g times the noise before and %.3g after, which nothing "
                  "here explains (was it pushed?); left out of the held-out errors, which are %.3g and %.3g %s with it",
                  d.run.c_str(), d.start, d.end, d.before, d.after, judged.before_all, judged.after_all,
                  unit == "noise" ? "times the noise" : unit.c_str());
    flow.notes.push_back(text);
  }
  std::vector<NamedEffect> effects = named_of(named);
  std::vector<Curve> curves = std::move(judged.curves);
  const std::vector<Curve> fitted = curves_of(problem, chosen.data, chosen.base, named, CURVES_OF_FITTED_RUNS);
  curves.insert(curves.end(), fitted.begin(), fitted.end());
  return {std::move(selected), std::move(effects), std::move(judged), std::move(curves)};
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
  // the moments of a mask have no common size, nor have the cells of a picture
  const bool has_pictures = !problem.recording.mask_sources.empty() || !problem.recording.video_sources.empty();
  flow.report_progress(1, 0,
                       "noise of " + std::to_string(problem.channels.size()) + " channels, " +
                           std::to_string(problem.runs.size()) + " runs");
  flow.notes.push_back(choose_time_step(flow.fitter, flow.predictor, problem, flow.base));
  flow.files.write_notes("1_measurement.json", flow.notes);
  return units.size() > 1 || has_pictures ? "noise" : *units.begin();
}

// Stage 2: windows that the model can follow, and what it leaves in them.
ChosenWindows find_residual(Workflow& flow) {
  ChosenWindows chosen = choose_windows(flow.fitter, flow.problem, flow.settings.simulated_seconds);
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
  Located located = find_where(flow, chosen);
  flow.files.write_where(located.where);
  return located;
}

// All that stage 4 screens.
std::vector<Candidate> all_candidates(Workflow& flow, const ChosenWindows& chosen, const Located& located) {
  std::vector<Candidate> candidates = make_candidates(flow.problem, located.touching);
  place_limits(flow.fitter, chosen.data, chosen.base, candidates);
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
  out.next_experiment = std::move(proof.selected.next_experiment);
  out.fit_after = proof.selected.error;
  out.before = proof.held_out.before;
  out.after = proof.held_out.after;
  out.floor = proof.held_out.floor;
  out.gap_closed = closed(out.before, out.after, out.floor);
  out.mask_gap_before = proof.held_out.mask_gap_before;
  out.mask_gap_after = proof.held_out.mask_gap_after;
  out.curves = std::move(proof.curves);
}

}  // namespace

void Workflow::report_progress(int stage, double share, const std::string& text) const {
  const double since = seconds();
  std::fprintf(stderr, "diagnose %d/7: %s  (%.0f s%s)\n", stage, text.c_str(), since,
               share > 0.02 && share < 1
                   ? (", about " + std::to_string(int(since * (1 - share) / share) + 1) + " s left").c_str()
                   : "");
}

bool Workflow::has_time(const std::string& something, double expected_seconds) {
  if (seconds() + expected_seconds < 60 * settings.minutes) return true;
  notes.push_back(
      fmt::format("{} was not looked for: {:.0f} s were over and it takes some {:.0f} s more; "
                  "`--minutes`, which is {:g}, gives it more",
                  something, seconds(), expected_seconds, settings.minutes));
  return false;
}

const char* verdict_name(Verdict verdict) {
  constexpr const char* NAMES[] = {"effect", "retune", "measurement", "none", "agrees"};
  return NAMES[int(verdict)];
}

Diagnosis diagnose(Device& device, Problem& problem, const Settings& settings, const std::filesystem::path& folder) {
  Workflow flow(device, problem, settings);
  flow.files.folder = folder;
  Diagnosis out;
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
  ChosenWindows chosen = find_residual(flow);
  out.fit_before = rms(chosen.base.residual);
  bool is_fine = agrees(problem, chosen.data, chosen.base);
  if (is_fine) out.supposed_noise = suppose_less_noise(problem, out.fit_before);
  if (!out.supposed_noise.empty()) {  // what would be named with less noise
    chosen = find_residual(flow);
    out.fit_before = rms(chosen.base.residual);
    is_fine = agrees(problem, chosen.data, chosen.base);
  }
  if (is_fine) {
    out.verdict = Verdict::agrees;
    out.candidates = std::make_shared<std::vector<Candidate>>();
    Selection nothing;
    nothing.error = out.fit_before;
    add_proof(out, prove(flow, chosen, std::move(nothing), out.unit));
    if (out.after > criteria().agrees_held_out * out.floor && out.floor > 0)
      flow.notes.push_back(
          fmt::format("the fitted runs agree with the scene, the held-out ones do not: {:.2g} times the noise",
                      out.after / out.floor));
  } else {
    Located located = locate(flow, chosen);
    out.candidates = std::make_shared<std::vector<Candidate>>(all_candidates(flow, chosen, located));
    flow.report_progress(4, 0.25, "screening " + std::to_string(out.candidates->size()) + " candidates");
    Selection selected = forward_selection(flow, *out.candidates, chosen.data, chosen.base);
    flow.report_progress(7, 0.9, "judging on the held-out runs");
    add_proof(out, prove(flow, chosen, std::move(selected), out.unit));
    const bool is_judged = out.floor > 0;
    bool is_proved = !out.effects.empty();
    if (settings.decide == Decide::workflow)
      is_proved = is_proved && is_judged && out.gap_closed >= criteria().gap_closed_least && out.after < out.before;
    out.verdict = is_proved ? verdict_of(out.effects) : Verdict::none;
    if (out.verdict == Verdict::none && is_judged && settings.decide == Decide::workflow &&
        flow.has_time("a law without a name")) {
      flow.report_progress(7, 0.6, "none of the known effects: looking for a law of the motion");
      if (std::optional<Regressed> found = regress(flow, chosen, located.where, out.unit == "noise")) {
        out.regressed = std::move(found->law);
        out.curves = std::move(found->curves);
      }
    }
    out.where = std::move(located.where);
    out.supposed_verdict = out.verdict;
    if (!out.supposed_noise.empty()) out.verdict = Verdict::none;
  }
  out.seconds = flow.seconds();
  out.simulations = flow.predictor.n_simulations();
  out.notes = std::move(flow.notes);
  if (!settings.keeps_simulations) journal.remove();
  return out;
}

}  // namespace pvg::diagnose
