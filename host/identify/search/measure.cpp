#include "host/identify/search/measure.hpp"

#include <fmt/format.h>

#include <cstdio>
#include <set>

#include "host/base/counted.hpp"
#include "host/identify/criteria.hpp"
#include "host/identify/data/noise.hpp"
#include "host/identify/fit/far_number.hpp"
#include "host/identify/fit/time_step.hpp"
#include "host/identify/sensing/video_sight.hpp"

namespace pvg::diagnose {
namespace {

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

}  // namespace

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
  flow.report_progress(
      1, 0, "noise of " + counted(problem.channels.size(), "channel") + ", " + counted(problem.runs.size(), "run"));
  choose_step(flow);
  if (flow.settings.halves_step) {
    flow.base.scene.solver.time_step /= 2;
    flow.notes.push_back(
        fmt::format("half that step, as asked for: {:.4g} ms", 1e3 * flow.base.scene.solver.time_step));
  }
  flow.files.write_notes("1_measurement.json", flow.notes);
  return units.size() > 1 || has_pictures ? "noise" : *units.begin();
}

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
  std::snprintf(text, sizeof text, "%s of %s; error as the scene stands %.3g times the noise",
                counted(chosen.data.windows.size(), "window").c_str(),
                chosen.length > 0 ? (std::to_string(chosen.length).substr(0, 4) + " s").c_str() : "whole runs",
                rms(chosen.base.residual));
  flow.notes.push_back(text);
  flow.report_progress(2, 0.15, text);
  flow.files.write_notes("2_residual.json", flow.notes);
  return chosen;
}

}  // namespace pvg::diagnose
