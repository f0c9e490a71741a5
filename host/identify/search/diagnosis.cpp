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

// Where, and which bodies touch. What is too weak to show in short windows is looked for in those of the fit.
std::vector<std::string> find_where(Workflow& flow, const ChosenWindows& chosen) {
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
  flow.out.where = where(chosen.data, chosen.base);
  if (flow.problem.can_restart && chosen.length != criteria().locate_window) {
    const FitData near = flow.fitter.prepare(
        make_windows(flow.problem, false, criteria().locate_window, criteria().n_windows_most), empty_model());
    if (!near.windows.empty()) {
      const std::vector<Cell> cells = where(near, flow.fitter.fit(near, {empty_model()}, 0).front());
      if (any_significant(cells)) flow.out.where = cells;
    }
  }
  return {touching.begin(), touching.end()};
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

// Stage 7: what stays of what has selected, and the curves. Returns whether there was a held-out run to judge by.
bool prove(Workflow& flow, const ChosenWindows& chosen, const std::vector<Fit>& selected) {
  const Problem& problem = flow.problem;
  Diagnosis& out = flow.out;
  std::vector<Model> models;
  for (const Fit& fit : selected) models.push_back(fit.model);
  const std::size_t most = most_windows(problem, flow.settings.simulated_seconds, chosen.length);
  HeldOut judged = judge_held_out(flow.fitter, problem, chosen.length, most, models, out.unit == "noise");
  const Fit& named = selected.empty() ? chosen.base : selected[std::max<std::size_t>(judged.kept, 1) - 1];
  out.effects = named_of(named);
  if (const std::size_t left = std::max<std::size_t>(judged.kept, 1);
      left < selected.size()) {  // the others proved nothing
    out.ranking.erase(out.ranking.begin(), out.ranking.begin() + std::ptrdiff_t(selected.size() - left));
    out.inseparable.resize(std::min(out.inseparable.size(), left));
    out.fit_after = out.ranking.front().error;
  }
  const bool any_held_out =
      std::any_of(problem.runs.begin(), problem.runs.end(), [](const Run& r) { return r.is_held_out; });
  if (any_held_out && judged.floor == 0) out.notes.push_back("the held-out runs could not be simulated to their end");
  for (const Disturbance& d : judged.disturbed) {
    char text[300];
    std::snprintf(text, sizeof text,
                  "held-out run %s, %.2f to %.2f s: wrong by %.3g times the noise before and %.3g after, which nothing "
                  "here explains (was it pushed?); left out of the held-out errors, which are %.3g and %.3g %s with it",
                  d.run.c_str(), d.start, d.end, d.before, d.after, judged.before_all, judged.after_all,
                  out.unit == "noise" ? "times the noise" : out.unit.c_str());
    out.notes.push_back(text);
  }
  out.before = judged.before;
  out.after = judged.after;
  out.floor = judged.floor;
  out.gap_closed = closed(out.before, out.after, out.floor);
  out.mask_gap_before = judged.mask_gap_before;
  out.mask_gap_after = judged.mask_gap_after;
  out.curves = std::move(judged.curves);
  const std::vector<Curve> fitted = curves_of(problem, chosen.data, chosen.base, named, CURVES_OF_FITTED_RUNS);
  out.curves.insert(out.curves.end(), fitted.begin(), fitted.end());
  return judged.floor > 0;
}

// Stage 1: noise, time step.
void measure(Workflow& flow) {
  Problem& problem = flow.problem;
  Diagnosis& out = flow.out;
  for (const Criterion& one : list_criteria())
    if (one.value != one.usual)
      out.notes.push_back(fmt::format("criterion {}: {:g} instead of {:g}", one.name, one.value, one.usual));
  measure_noise(problem);
  if (VideoSight* video = flow.predictor.video()) add_noise_of_pictures(*video, problem);
  flow.base.scene = problem.scene.scene;
  std::set<std::string> units;
  for (const Channel& c : problem.channels) {
    char text[200];
    std::snprintf(text, sizeof text, "noise of the %s: %.3g %s%s", c.name.c_str(), c.sigma, c.unit.c_str(),
                  c.is_noise_known ? ", as given"
                  : c.is_noise_assumed
                      ? ", taken as a hundredth of the range, too few samples stand side by side to measure it"
                      : ", measured from third differences");
    out.notes.push_back(text);
    units.insert(c.unit);
    for (const Run& run : problem.runs)
      if (const double noise_scale = run.noise_scale[std::size_t(&c - problem.channels.data())]; noise_scale > 1) {
        std::snprintf(text, sizeof text, "noise of the %s in run %s: %.3g %s", c.name.c_str(), run.name.c_str(),
                      c.sigma * noise_scale, c.unit.c_str());
        out.notes.push_back(text);
      }
  }
  // the moments of a mask have no common size, nor have the cells of a picture
  const bool has_pictures = !problem.recording.mask_sources.empty() || !problem.recording.video_sources.empty();
  out.unit = units.size() > 1 || has_pictures ? "noise" : *units.begin();
  flow.report_progress(1, 0,
                       "noise of " + std::to_string(problem.channels.size()) + " channels, " +
                           std::to_string(problem.runs.size()) + " runs");
  out.notes.push_back(choose_time_step(flow.fitter, flow.predictor, problem, flow.base));
  out.used = flow.base.scene;
  flow.files.write_notes("1_measurement.json", out.notes);
}

// Stage 2.
ChosenWindows find_residual(Workflow& flow) {
  ChosenWindows chosen = choose_windows(flow.fitter, flow.problem, flow.settings.simulated_seconds);
  flow.out.fit_before = flow.out.fit_after = rms(chosen.base.residual);
  char text[200];
  std::snprintf(text, sizeof text, "%zu windows of %s; error as the scene stands %.3g times the noise",
                chosen.data.windows.size(),
                chosen.length > 0 ? (std::to_string(chosen.length).substr(0, 4) + " s").c_str() : "whole runs",
                flow.out.fit_before);
  flow.out.notes.push_back(text);
  flow.report_progress(2, 0.15, text);
  flow.files.write_notes("2_residual.json", flow.out.notes);
  return chosen;
}

void locate(Workflow& flow, const ChosenWindows& chosen) {
  Diagnosis& out = flow.out;
  const std::vector<std::string> touching = find_where(flow, chosen);
  flow.files.write_where(out.where);
  out.candidates = std::make_shared<std::vector<Candidate>>(make_candidates(flow.problem, touching));
  place_limits(flow.fitter, chosen.data, chosen.base, *out.candidates);
  flow.report_progress(3, 0.2,
                       out.where.empty() ? "nothing located"
                                         : out.where[0].body + ", " + out.where[0].phase + ": " +
                                               std::to_string(int(100 * out.where[0].share)) + " % of the misfit");
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
  out.notes.push_back(
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
  Diagnosis& out = flow.out;
  Journal journal;
  if (!folder.empty()) {
    journal = Journal(folder / "simulated.bin",
                      journal_key(problem, std::to_string(settings.max_effects) + std::to_string(int(settings.decide)) +
                                               device.info().name));
    if (!settings.simulates) journal.set_read_only();
    flow.predictor.keep_in(&journal);
  }
  measure(flow);
  const ChosenWindows chosen = find_residual(flow);
  if (agrees(problem, chosen.data, chosen.base)) {
    out.verdict = Verdict::agrees;
    out.candidates = std::make_shared<std::vector<Candidate>>();
    prove(flow, chosen, {});
    if (out.after > criteria().agrees_held_out * out.floor && out.floor > 0)
      out.notes.push_back(
          fmt::format("the fitted runs agree with the scene, the held-out ones do not: {:.2g} times the noise",
                      out.after / out.floor));
  } else {
    locate(flow, chosen);
    flow.report_progress(4, 0.25, "screening " + std::to_string(out.candidates->size()) + " candidates");
    const std::vector<Fit> selected = forward_selection(flow, chosen.data, chosen.base);
    flow.report_progress(7, 0.9, "judging on the held-out runs");
    const bool is_judged = prove(flow, chosen, selected);
    bool is_proved = !out.effects.empty();
    if (settings.decide == Decide::workflow)
      is_proved = is_proved && is_judged && out.gap_closed >= criteria().gap_closed_least && out.after < out.before;
    out.verdict = is_proved ? verdict_of(out.effects) : Verdict::none;
    if (out.verdict == Verdict::none && is_judged && settings.decide == Decide::workflow &&
        flow.has_time("a law without a name")) {
      flow.report_progress(7, 0.6, "none of the known effects: looking for a law of the motion");
      out.regressed = regress(flow, chosen);
    }
  }
  out.seconds = flow.seconds();
  out.simulations = flow.predictor.n_simulations();
  if (!settings.keeps_simulations) journal.remove();
  return std::move(out);
}

}  // namespace pvg::diagnose
