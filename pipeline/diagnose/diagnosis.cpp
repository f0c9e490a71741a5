#include "pipeline/diagnose/diagnosis.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <set>

#include "host/base/error.hpp"
#include "pipeline/diagnose/choose_windows.hpp"
#include "pipeline/diagnose/journal.hpp"
#include "pipeline/diagnose/noise.hpp"
#include "pipeline/diagnose/screen.hpp"
#include "pipeline/diagnose/stage_files.hpp"
#include "pipeline/diagnose/time_step.hpp"

namespace pvg::diagnose {
namespace {

using Eigen::VectorXd;
constexpr double SHORT_WINDOW = 0.25;                   // of localisation [s]
constexpr double AGREES_RMS = 1.15, AGREES_CELL = 1.5;  // of residuals in units of noise
constexpr double LEAST_GAP_CLOSED = 0.6;                // on held-out runs, for an effect to be named
constexpr double LEAST_STEP =
    0.3;  // of what is left on fitting runs, for a further effect to be tried on held-out ones
constexpr double SECOND_LOOK = 1.5;        // times the noise floor: look for another effect
constexpr std::size_t N_FINALISTS = 5;     // candidates that are fitted to the end
constexpr int MORE_STEPS = 6;              // of these
constexpr std::size_t MOST_EXCHANGED = 3;  // other first effects that are tried beside a second one
constexpr double HOPELESS = 100;           // by which a finalist's log-likelihood may be worse than the best one's

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

struct Workflow {
  Workflow(Device& device, Problem& problem, const Settings& settings)
      : problem(problem), settings(settings), predictor(device, problem) {}
  Problem& problem;
  const Settings& settings;
  std::chrono::steady_clock::time_point start = std::chrono::steady_clock::now();
  Predictor predictor;
  Variant base;
  Fitter fitter{predictor, base};
  Diagnosis out;
  StageFiles files;

  void tell(int stage, double share, const std::string& text) const {
    const double seconds = seconds_since(start);
    std::fprintf(stderr, "diagnose %d/7: %s  (%.0f s%s)\n", stage, text.c_str(), seconds,
                 share > 0.02 && share < 1
                     ? (", about " + std::to_string(int(seconds * (1 - share) / share) + 1) + " s left").c_str()
                     : "");
  }
};

Model empty_model() { return {{}, VectorXd(), VectorXd()}; }

bool any_significant(const std::vector<Cell>& cells) {
  return std::any_of(cells.begin(), cells.end(), [](const Cell& cell) { return cell.is_significant; });
}

// Where, and which bodies touch. What is too weak to show in short windows is looked for in `data`.
std::vector<std::string> find_where(Workflow& flow, const FitData& data, const Fit& base) {
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
  flow.out.where = where(data, base);
  if (flow.problem.can_restart) {
    const FitData near = flow.fitter.prepare(make_windows(flow.problem, false, SHORT_WINDOW, 40), empty_model());
    if (!near.windows.empty()) {
      const std::vector<Cell> cells = where(near, flow.fitter.fit(near, {empty_model()}, 0).front());
      if (any_significant(cells)) flow.out.where = cells;
    }
  }
  return {touching.begin(), touching.end()};
}

bool agrees(const Problem& problem, const FitData& data, const Fit& base) {
  if (rms(base.residual) > AGREES_RMS) return false;
  std::vector<std::vector<Phase>> one;
  for (const Window& window : data.windows) one.push_back(std::vector<Phase>(window.data.size(), Phase::free));
  for (const Cell& cell : localise(problem, data.windows, base.residual, one))
    if (cell.is_significant && cell.rms > AGREES_CELL) return false;
  return true;
}

RankedModel ranked(const Judged& judged) {
  RankedModel model{judged.fit->model.parts, judged.error, judged.evidence, judged.probability, {}};
  for (const double x : judged.fit->model.x) model.values.push_back(x);
  return model;
}

std::vector<std::string> labels_of(const Model& model, std::size_t after) {
  std::vector<std::string> labels;
  for (std::size_t i = after; i < model.parts.size(); ++i) labels.push_back(model.parts[i]->label());
  return labels;
}

// One round: screen all candidates beside what is in the base already, fit the best, decide.
struct Round {
  std::vector<Fit> fits;
  Decision decision;
};

// The fits to the end of those that may still win, all with slopes and covariances.
std::vector<Fit> fit_best(Fitter& fitter, const FitData& data, const std::vector<Screened>& best) {
  std::vector<Model> models;
  for (const Screened& s : best) models.push_back(s.model);
  std::vector<Fit> fits = fitter.begin(data, std::move(models));
  std::erase_if(fits, [](const Fit& fit) { return !fit.is_well; });
  fitter.improve(data, fits, 2);
  std::vector<double> scales;  // of each window by the fit that has it best
  for (const Fit& fit : fits) {
    const std::vector<double> of = window_scales(fit.residual);
    if (scales.empty()) scales = of;
    for (std::size_t w = 0; w < of.size(); ++w) scales[w] = std::min(scales[w], of[w]);
  }
  const auto key = [&](const Fit& fit) { return robust_cost(fit.residual, scales); };
  std::stable_sort(fits.begin(), fits.end(), [&](const Fit& a, const Fit& b) { return key(a) < key(b); });
  for (std::size_t i = 0; i < fits.size(); ++i)
    fits[i].is_given_up = i >= N_FINALISTS || key(fits[i]) > key(fits[0]) + HOPELESS * fits[0].scale * fits[0].scale;
  fitter.improve(data, fits, MORE_STEPS);
  fitter.finish(data, fits);
  return fits;
}

Round run_round(Workflow& flow, const FitData& data, const Fit& base, int number) {
  std::vector<const Candidate*> candidates;
  for (const Candidate& c : *flow.out.candidates)
    if (std::find(base.model.parts.begin(), base.model.parts.end(), &c) == base.model.parts.end() &&
        (flow.settings.decide != Decide::retune || c.family == Family::parameter))
      candidates.push_back(&c);
  const std::vector<Screened> screened = screen(flow.fitter, data, base, candidates);
  flow.files.write_screen(number, screened);
  const std::vector<Screened> best = shortlist(screened, flow.settings.n_fitted);
  flow.tell(5, number == 1 ? 0.4 : 0.75,
            "fitting " + std::to_string(best.size()) + " of " + std::to_string(candidates.size()) + " candidates");
  Round round;
  if (best.empty()) return round;
  if (flow.settings.decide == Decide::weak) {  // as the linear regression has them
    round.fits = flow.fitter.begin(data, {best[0].model});
    std::erase_if(round.fits, [](const Fit& fit) { return !fit.is_well; });
    flow.fitter.conclude(data, round.fits);
  } else {
    round.fits = fit_best(flow.fitter, data, best);
  }
  round.decision =
      flow.settings.decide == Decide::workflow ? decide(data, base, round.fits) : decide_lowest(base, round.fits);
  return round;
}

std::vector<NamedEffect> named_of(const Fit& fit) {
  std::vector<NamedEffect> named;
  Eigen::Index at = 0;
  for (const Candidate* part : fit.model.parts) {
    NamedEffect effect{part, {}};
    for (const Parameter& p : part->parameters) {
      const double sigma = std::sqrt(std::max(fit.covariance(at, at), 0.0)), x = fit.model.x[at++];
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

Model without(const Model& model, std::size_t left_out) {
  Model less;
  std::vector<double> x, scale;
  Eigen::Index at = 0;
  for (std::size_t i = 0; i < model.parts.size(); ++i) {
    for (std::size_t k = 0; k < model.parts[i]->parameters.size(); ++k, ++at)
      if (i != left_out) x.push_back(model.x[at]), scale.push_back(model.scale[at]);
    if (i != left_out) less.parts.push_back(model.parts[i]);
  }
  less.x = Eigen::Map<const VectorXd>(x.data(), Eigen::Index(x.size()));
  less.scale = Eigen::Map<const VectorXd>(scale.data(), Eigen::Index(scale.size()));
  return less;
}

// Others of the first round in place of the model's first part.
std::vector<Model> exchanged(const Model& model, const std::vector<Fit>& first_round) {
  std::vector<Model> models;
  const Model rest = without(model, 0);
  for (const Fit& first : first_round) {
    const Candidate* part = first.model.parts.front();
    if (models.size() >= MOST_EXCHANGED) break;
    if (std::find(model.parts.begin(), model.parts.end(), part) != model.parts.end()) continue;
    Model other = first.model;
    other.parts.insert(other.parts.end(), rest.parts.begin(), rest.parts.end());
    other.x.conservativeResize(first.model.x.size() + rest.x.size());
    other.x.tail(rest.x.size()) = rest.x;
    other.scale.conservativeResize(other.x.size());
    other.scale.tail(rest.x.size()) = rest.scale;
    models.push_back(std::move(other));
  }
  return models;
}

// An effect that was found first may only have stood in: for one that was found later, without it the fit is as good
// then; or for another of the first round, which is better beside what was found later.
Fit reconsidered(Workflow& flow, const FitData& data, const Fit& base, const Fit& fit,
                 const std::vector<Fit>& first_round) {
  std::vector<Model> models = exchanged(fit.model, first_round);
  for (std::size_t i = 0; i + 1 < fit.model.parts.size(); ++i) models.push_back(without(fit.model, i));
  std::vector<Fit> fits = flow.fitter.begin(data, std::move(models));
  std::erase_if(fits, [](const Fit& other) { return !other.is_well; });
  flow.fitter.improve(data, fits, MORE_STEPS);
  flow.fitter.finish(data, fits);
  fits.push_back(fit);
  const Decision decision = decide(data, base, fits);
  return decision.chosen >= 0 ? *decision.ranking[std::size_t(decision.chosen)].fit : fit;
}

// What a coarse time step does wrong, and how the windows answer to their starts, is another matter with the effect
// than without: both are found again there, and the fit goes on.
Fit settled(Workflow& flow, FitData& data, const Fit& fit) {
  FitData near = flow.fitter.prepare_near(data.windows, fit.model);
  if (near.windows.size() != data.windows.size()) return fit;
  Fit better = flow.fitter.fit(near, {fit.model}, MORE_STEPS).front();
  if (!better.is_well || robust_cost(better.residual, fit.scale) > robust_cost(fit.residual, fit.scale)) return fit;
  data = std::move(near);
  return better;
}

// Looks for one effect after the other, each beside those before. Returns the fits that grew by one effect each.
std::vector<Fit> grow(Workflow& flow, FitData data, const Fit& base) {
  Diagnosis& out = flow.out;
  std::vector<Fit> grown, first_round;
  Fit named = base;
  // one round more than effects, for one that took another's place
  for (int number = 1; number <= flow.settings.max_effects + (flow.settings.max_effects > 1); ++number) {
    if (int(named.model.parts.size()) >= flow.settings.max_effects) break;
    const Round round = run_round(flow, data, named, number);
    flow.files.write_fits(number, round.decision);
    const Decision& decision = round.decision;
    if (number == 1)
      for (const Judged& judged : decision.ranking) out.ranking.push_back(ranked(judged));
    if (decision.chosen < 0) break;
    const Judged& chosen = decision.ranking[std::size_t(decision.chosen)];
    if (number > 1 && closed(decision.base_error, chosen.error, 1) < LEAST_STEP) break;
    if (number > 1)
      out.ranking.insert(out.ranking.begin(), ranked(chosen));
    else
      std::rotate(out.ranking.begin(), out.ranking.begin() + decision.chosen,
                  out.ranking.begin() + decision.chosen + 1);
    std::vector<std::string> set;
    for (const std::size_t i : decision.inseparable) {
      const std::vector<std::string> labels = labels_of(decision.ranking[i].fit->model, named.model.parts.size());
      set.insert(set.end(), labels.begin(), labels.end());
    }
    if (!set.empty()) out.inseparable.push_back(set);
    if (!decision.inseparable.empty() && out.next_experiment.empty())
      out.next_experiment = chosen.fit->model.parts.back()->experiment;
    const std::size_t n_parts = chosen.fit->model.parts.size();
    if (number == 1)
      for (const Judged& judged : decision.ranking)
        if (judged.passes) first_round.push_back(*judged.fit);
    named = n_parts > 1 && flow.settings.decide == Decide::workflow
                ? reconsidered(flow, data, base, *chosen.fit, first_round)
                : *chosen.fit;
    if (flow.settings.decide == Decide::workflow) named = settled(flow, data, named);
    const double error = rms(named.residual);
    if (named.model.parts != chosen.fit->model.parts)
      out.ranking.front() = {
          named.model.parts, error, chosen.evidence, chosen.probability, {named.model.x.begin(), named.model.x.end()}};
    if (named.model.parts.size() < n_parts) {  // what remains stands alone
      grown.clear();
      out.inseparable.clear();
    }
    grown.push_back(named);
    out.fit_after = error;
    if (error < SECOND_LOOK) break;
    if (int(named.model.parts.size()) < flow.settings.max_effects)
      flow.tell(4, 0.6,
                "what " + named.model.parts.back()->label() + " leaves is " + std::to_string(error) +
                    " times the noise: looking for another effect");
  }
  return grown;
}

// Stage 7: what stays of what has grown, and the curves. Returns whether there was a held-out run to judge by.
bool prove(Workflow& flow, const ChosenWindows& chosen, const std::vector<Fit>& grown) {
  const Problem& problem = flow.problem;
  Diagnosis& out = flow.out;
  std::vector<Model> models;
  for (const Fit& fit : grown) models.push_back(fit.model);
  const std::size_t most = most_windows(problem, flow.settings.simulated_seconds, chosen.length);
  HeldOut judged = judge_held_out(flow.fitter, problem, chosen.length, most, models, out.unit == "noise");
  const Fit& named = grown.empty() ? chosen.base : grown[std::max<std::size_t>(judged.kept, 1) - 1];
  out.effects = named_of(named);
  if (const std::size_t left = std::max<std::size_t>(judged.kept, 1);
      left < grown.size()) {  // the others proved nothing
    out.ranking.erase(out.ranking.begin(), out.ranking.begin() + std::ptrdiff_t(grown.size() - left));
    out.inseparable.resize(std::min(out.inseparable.size(), left));
    out.fit_after = out.ranking.front().error;
  }
  const bool any_held_out =
      std::any_of(problem.runs.begin(), problem.runs.end(), [](const Run& r) { return r.is_held_out; });
  if (any_held_out && judged.floor == 0) out.notes.push_back("the held-out runs could not be simulated to their end");
  out.before = judged.before;
  out.after = judged.after;
  out.floor = judged.floor;
  out.gap_closed = closed(out.before, out.after, out.floor);
  out.curves = std::move(judged.curves);
  const std::vector<Curve> fitted = curves_of(problem, chosen.data, chosen.base, named, 4);
  out.curves.insert(out.curves.end(), fitted.begin(), fitted.end());
  return judged.floor > 0;
}

// Stage 1: noise, time step.
void measure(Workflow& flow) {
  Problem& problem = flow.problem;
  Diagnosis& out = flow.out;
  measure_noise(problem);
  flow.base.scene = problem.scene.scene;
  std::set<std::string> units;
  for (const Channel& c : problem.channels) {
    char text[200];
    std::snprintf(text, sizeof text, "noise of the %s: %.3g %s%s", c.name.c_str(), c.sigma, c.unit.c_str(),
                  c.is_noise_known ? ", as given" : ", measured from third differences");
    out.notes.push_back(text);
    units.insert(c.unit);
  }
  out.unit = units.size() > 1 ? "noise" : *units.begin();
  flow.tell(1, 0,
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
  flow.tell(2, 0.15, text);
  flow.files.write_notes("2_residual.json", flow.out.notes);
  return chosen;
}

void locate(Workflow& flow, const ChosenWindows& chosen) {
  Diagnosis& out = flow.out;
  const std::vector<std::string> touching = find_where(flow, chosen.data, chosen.base);
  flow.files.write_where(out.where);
  out.candidates = std::make_shared<std::vector<Candidate>>(make_candidates(flow.problem, touching));
  flow.tell(3, 0.2,
            out.where.empty() ? "nothing located"
                              : out.where[0].body + ", " + out.where[0].phase + ": " +
                                    std::to_string(int(100 * out.where[0].share)) + " % of the misfit");
}

}  // namespace

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
    flow.predictor.keep_in(&journal);
  }
  measure(flow);
  const ChosenWindows chosen = find_residual(flow);
  if (agrees(problem, chosen.data, chosen.base)) {
    out.verdict = Verdict::agrees;
    out.candidates = std::make_shared<std::vector<Candidate>>();
    prove(flow, chosen, {});
  } else {
    locate(flow, chosen);
    flow.tell(4, 0.25, "screening " + std::to_string(out.candidates->size()) + " candidates");
    const std::vector<Fit> grown = grow(flow, chosen.data, chosen.base);
    flow.tell(6, 0.9, "judging on the held-out runs");
    const bool is_judged = prove(flow, chosen, grown);
    bool is_proved = !out.effects.empty();
    if (settings.decide == Decide::workflow)
      is_proved = is_proved && is_judged && out.gap_closed >= LEAST_GAP_CLOSED && out.after < out.before;
    out.verdict = is_proved ? verdict_of(out.effects) : Verdict::none;
  }
  out.seconds = seconds_since(flow.start);
  out.simulations = flow.predictor.n_simulations();
  journal.remove();
  return std::move(out);
}

}  // namespace pvg::diagnose
