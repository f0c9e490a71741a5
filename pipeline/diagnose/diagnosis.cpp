#include "pipeline/diagnose/diagnosis.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <set>

#include "host/base/error.hpp"
#include "pipeline/diagnose/noise.hpp"
#include "pipeline/diagnose/screen.hpp"
#include "pipeline/diagnose/stage_files.hpp"
#include "pipeline/diagnose/time_step.hpp"

namespace pvg::diagnose {
namespace {

using Eigen::VectorXd;
constexpr double COHERENT = 0.35;  // misfit over signal up to which a window's model is near enough to be linearised
constexpr double SHORT_WINDOW = 0.25;                   // of localisation [s]
constexpr double AGREES_RMS = 1.15, AGREES_CELL = 1.5;  // of residuals in units of noise
constexpr double LEAST_GAP_CLOSED = 0.6;                // on held-out runs, for an effect to be named
constexpr double LEAST_GAP_OF_SECOND =
    0.3;                             // of what is left on held-out runs, for a further effect to be named beside
constexpr double SECOND_LOOK = 1.5;  // times the noise floor: look for another effect

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

struct Workflow {
  Workflow(Device& device, Problem& problem, const Settings& settings)
      : device(device), problem(problem), settings(settings) {}
  Device& device;
  Problem& problem;
  const Settings& settings;
  std::chrono::steady_clock::time_point start = std::chrono::steady_clock::now();
  Predictor predictor{device, problem};
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

// Root mean square of what a window's channels do, in units of noise, about their means.
double signal_of(const Problem& problem, const Window& window) {
  const Run& run = problem.runs[std::size_t(window.run)];
  std::vector<std::vector<double>> of(problem.channels.size() * 4);
  for (const Datum& d : window.data) {
    const Channel& c = problem.channels[std::size_t(d.channel)];
    of[std::size_t(d.channel) * 4 + std::size_t(d.component)].push_back(
        run.values[std::size_t(d.channel)][d.sample * std::size_t(c.width) + std::size_t(d.component)] / c.sigma);
  }
  double sum = 0, n = 0;
  for (const std::vector<double>& values : of) {
    double mean = 0;
    for (const double v : values) mean += v / double(values.size());
    for (const double v : values) sum += (v - mean) * (v - mean);
    n += double(values.size());
  }
  return n > 0 ? std::sqrt(sum / n) : 0;
}

std::size_t most_windows(const Problem& problem, const Settings& settings, double length) {
  double longest = 0;
  for (const Run& run : problem.runs) longest = std::max(longest, run.t.back() - run.t.front());
  const double each = length > 0 ? length : longest;
  return std::clamp<std::size_t>(std::size_t(settings.simulated_seconds / std::max(each, 1e-6)), 4, 40);
}

// Whole runs, or shorter windows where the model as it stands parts too far from the measurement to be linearised.
FitData choose_windows(Workflow& flow, const Model& at, double& length, Fit& fit) {
  const Problem& problem = flow.problem;
  FitData data;
  const std::vector<double> lengths =
      problem.can_restart ? std::vector<double>{0, 2, 1, 0.5, 0.25} : std::vector<double>{0};
  for (const double tried : lengths) {
    double longest = 0;
    for (const Run& run : problem.runs) longest = std::max(longest, run.t.back() - run.t.front());
    if (tried > 0 && tried > 0.8 * longest) continue;
    if (tried == 0 && longest > 8 && problem.can_restart) continue;
    length = tried;
    data = flow.fitter.prepare(make_windows(problem, false, tried, most_windows(problem, flow.settings, tried)), at);
    if (data.windows.empty()) continue;
    fit = flow.fitter.fit(data, {at}, 0).front();
    std::size_t n_near = 0;
    for (std::size_t w = 0; w < data.windows.size(); ++w)
      n_near += rms({fit.residual[w]}) < std::max(COHERENT * signal_of(problem, data.windows[w]), 3.0);
    if (4 * n_near >= 3 * data.windows.size()) break;
  }
  if (data.windows.empty())
    throw Failure(problem.recording.file.string() +
                  ": the scene could not be simulated to the end of any window of the fitting runs; run it by "
                  "`phyvisgen simulate` and see what fails");
  return data;
}

Model empty_model() { return {{}, VectorXd(), VectorXd()}; }

// Where, and which bodies touch.
std::vector<std::string> find_where(Workflow& flow, const FitData& data, const Fit& base) {
  FitData near = data;
  Fit fit = base;
  if (flow.problem.can_restart) {
    near = flow.fitter.prepare(make_windows(flow.problem, false, SHORT_WINDOW, 40), empty_model());
    if (near.windows.empty())
      near = data;
    else
      fit = flow.fitter.fit(near, {empty_model()}, 0).front();
  }
  std::vector<std::vector<Prediction>> found = flow.fitter.evaluate(near, {empty_model()}, {fit.delta}, true);
  std::vector<std::vector<Phase>> phases;
  std::set<std::string> touching;
  for (const Prediction& p : found[0]) {
    phases.push_back(p.phase);
    touching.insert(p.touching.begin(), p.touching.end());
  }
  flow.out.where = localise(flow.problem, near.windows, fit.residual, phases);
  // contacts of later times show in whole windows only
  found = flow.fitter.evaluate(data, {empty_model()}, {base.delta}, true);
  for (const Prediction& p : found[0]) touching.insert(p.touching.begin(), p.touching.end());
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

Round run_round(Workflow& flow, const FitData& data, const Fit& base, int number) {
  std::vector<const Candidate*> candidates;
  for (const Candidate& c : *flow.out.candidates)
    if (std::find(base.model.parts.begin(), base.model.parts.end(), &c) == base.model.parts.end())
      candidates.push_back(&c);
  const std::vector<Screened> screened = screen(flow.fitter, data, base, candidates);
  flow.files.write_screen(number, screened);
  const std::vector<Screened> best = shortlist(screened, flow.settings.n_fitted);
  flow.tell(5, number == 1 ? 0.35 : 0.75,
            "fitting " + std::to_string(best.size()) + " of " + std::to_string(candidates.size()) + " candidates");
  std::vector<Model> models;
  for (const Screened& s : best) models.push_back(s.model);
  Round round;
  if (models.empty()) return round;
  // a few steps for all, more for those that may win
  std::vector<Fit> fits = flow.fitter.fit(data, models, 2);
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < fits.size(); ++i)
    if (fits[i].is_well) order.push_back(i);
  const auto key = [&](std::size_t i) { return robust_cost(fits[i].residual, 1); };
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return key(a) < key(b); });
  std::vector<Model> again;
  for (std::size_t i = 0; i < order.size(); ++i)
    if (i < 5)
      again.push_back(fits[order[i]].model);
    else
      round.fits.push_back(fits[order[i]]);
  if (!again.empty())
    for (Fit& fit : flow.fitter.fit(data, again, 3)) round.fits.push_back(std::move(fit));
  round.decision = decide(data, base, round.fits);
  return round;
}

// Errors of the held-out runs in the channels' unit, or in units of noise where they have several.
struct HeldOut {
  double before = 0, after = 0, floor = 0;
  std::vector<Curve> curves;
};

double error_in(const Problem& problem, const FitData& data, const std::vector<VectorXd>& residual, bool in_noise) {
  double sum = 0, n = 0;
  for (std::size_t w = 0; w < data.windows.size(); ++w)
    for (std::size_t i = 0; i < data.windows[w].data.size(); ++i) {
      const double sigma = in_noise ? 1 : problem.channels[std::size_t(data.windows[w].data[i].channel)].sigma;
      const double r = residual[w][Eigen::Index(i)] * sigma;
      sum += r * r;
      n += 1;
    }
  return n > 0 ? std::sqrt(sum / n) : 0;
}

std::vector<Curve> curves_of(const Problem& problem, const FitData& data, const Fit& before, const Fit& after,
                             std::size_t most) {
  std::vector<Curve> curves;
  for (std::size_t w = 0; w < data.windows.size() && curves.size() < most; ++w) {
    const Window& window = data.windows[w];
    const Run& run = problem.runs[std::size_t(window.run)];
    for (std::size_t c = 0; c < problem.channels.size(); ++c) {
      const Channel& channel = problem.channels[c];
      for (int k = 0; k < channel.n; ++k) {
        Curve curve{run.name,     channel.name + (channel.n > 1 ? std::string(", ") + "xyz"[k] : ""),
                    channel.unit, run.is_held_out,
                    {},           {},
                    {},           {}};
        for (std::size_t i = 0; i < window.data.size(); ++i) {
          const Datum& d = window.data[i];
          if (d.channel != int(c) || d.component != k) continue;
          const bool turn = channel.kind == RecordedChannel::Kind::orientation;  // shown as deviations
          const double measured = turn ? 0 : run.values[c][d.sample * std::size_t(channel.width) + std::size_t(k)];
          curve.t.push_back(run.t[d.sample]);
          curve.measured.push_back(measured);
          curve.before.push_back(measured - before.residual[w][Eigen::Index(i)] * channel.sigma);
          curve.after.push_back(measured - after.residual[w][Eigen::Index(i)] * channel.sigma);
        }
        if (!curve.t.empty()) curves.push_back(std::move(curve));
      }
    }
  }
  return curves;
}

// Models that grow by one effect each; an effect stays only if it closes enough of what was left before it. How many
// stay.
std::size_t judge_held_out(Workflow& flow, double length, const std::vector<Model>& grown, bool in_noise,
                           HeldOut& result) {
  std::vector<Window> windows =
      make_windows(flow.problem, true, length, most_windows(flow.problem, flow.settings, length));
  if (windows.empty()) return grown.size();
  const FitData data = flow.fitter.prepare(std::move(windows), empty_model());
  if (data.windows.empty()) return grown.size();
  std::vector<Model> models = grown;
  models.insert(models.begin(), empty_model());
  const std::vector<Fit> fits = flow.fitter.fit(data, models, 0);
  if (!fits[0].is_well) return grown.size();
  std::vector<VectorXd> ones;
  for (const Window& window : data.windows) ones.push_back(VectorXd::Ones(Eigen::Index(window.data.size())));
  result.floor = error_in(flow.problem, data, ones, in_noise);
  result.before = result.after = error_in(flow.problem, data, fits[0].residual, in_noise);
  std::size_t kept = 0;
  for (std::size_t m = 1; m < fits.size() && fits[m].is_well; ++m) {
    const double after = error_in(flow.problem, data, fits[m].residual, in_noise);
    if (m > 1 && after - result.floor > (1 - LEAST_GAP_OF_SECOND) * (result.after - result.floor)) break;
    result.after = after;
    kept = m;
  }
  result.curves = curves_of(flow.problem, data, fits[0], fits[kept], 8);
  return kept;
}

double closed(double before, double after, double floor) {
  return before > floor ? std::clamp(1 - (after - floor) / (before - floor), -10.0, 1.0) : 0;
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

}  // namespace

const char* verdict_name(Verdict verdict) {
  constexpr const char* NAMES[] = {"effect", "retune", "measurement", "none", "agrees"};
  return NAMES[int(verdict)];
}

Diagnosis diagnose(Device& device, Problem& problem, const Settings& settings, const std::filesystem::path& folder) {
  Workflow flow(device, problem, settings);
  flow.files.folder = folder;
  Diagnosis& out = flow.out;
  measure_noise(problem);
  flow.base.scene = problem.scene.scene;
  for (const Channel& c : problem.channels) {
    char text[200];
    std::snprintf(text, sizeof text, "noise of the %s: %.3g %s%s", c.name.c_str(), c.sigma, c.unit.c_str(),
                  c.is_noise_known ? ", as given" : ", measured from third differences");
    out.notes.push_back(text);
  }
  flow.files.write_notes("1_measurement.json", out.notes);
  flow.tell(1, 0,
            "noise of " + std::to_string(problem.channels.size()) + " channels, " +
                std::to_string(problem.runs.size()) + " runs");
  out.notes.push_back(choose_time_step(flow.fitter, flow.predictor, problem, flow.base));
  out.used = flow.base.scene;
  double length = 0;
  Fit base;
  const FitData data = choose_windows(flow, empty_model(), length, base);
  base.slope.assign(data.windows.size(), {});
  for (std::size_t w = 0; w < data.windows.size(); ++w) base.slope[w].resize(base.residual[w].size(), 0);
  base.scale = robust_scale(base.residual);
  base.cost = robust_cost(base.residual, base.scale);
  char text[200];
  std::snprintf(text, sizeof text, "%zu windows of %s; error as the scene stands %.3g times the noise",
                data.windows.size(), length > 0 ? (std::to_string(length).substr(0, 4) + " s").c_str() : "whole runs",
                rms(base.residual));
  out.notes.push_back(text);
  flow.tell(2, 0.08, text);
  flow.files.write_notes("2_residual.json", out.notes);
  const std::vector<std::string> touching = find_where(flow, data, base);
  flow.files.write_where(out.where);
  std::set<std::string> units;
  for (const Channel& c : problem.channels) units.insert(c.unit);
  const bool in_noise = units.size() > 1;
  out.unit = in_noise ? "noise" : *units.begin();
  out.candidates = std::make_shared<std::vector<Candidate>>(make_candidates(problem, touching));
  out.fit_before = out.fit_after = rms(base.residual);
  std::vector<Fit> grown;  // by one effect each
  const auto finish = [&] {
    const bool any_held_out =
        std::any_of(problem.runs.begin(), problem.runs.end(), [](const Run& r) { return r.is_held_out; });
    HeldOut judged;
    std::vector<Model> models;
    for (const Fit& fit : grown) models.push_back(fit.model);
    const std::size_t kept = judge_held_out(flow, length, models, in_noise, judged);
    const Fit& named = kept > 0 && !grown.empty() ? grown[std::min(kept, grown.size()) - 1]
                       : grown.empty()            ? base
                                                  : grown[0];
    out.effects = named_of(named);
    if (const std::size_t left = std::max<std::size_t>(kept, 1); left < grown.size()) {  // the others proved nothing
      out.ranking.erase(out.ranking.begin(), out.ranking.begin() + std::ptrdiff_t(grown.size() - left));
      out.inseparable.resize(std::min(out.inseparable.size(), left));
      out.fit_after = out.ranking.front().error;
    }
    if (any_held_out && judged.floor == 0) out.notes.push_back("the held-out runs could not be simulated to their end");
    out.before = judged.before;
    out.after = judged.after;
    out.floor = judged.floor;
    out.gap_closed = closed(out.before, out.after, out.floor);
    out.curves = std::move(judged.curves);
    const std::vector<Curve> fitted = curves_of(problem, data, base, named, 4);
    out.curves.insert(out.curves.end(), fitted.begin(), fitted.end());
    return judged.floor > 0;
  };
  const auto done = [&] {
    out.seconds = seconds_since(flow.start);
    out.simulations = flow.predictor.n_simulations();
    return std::move(out);
  };
  if (agrees(problem, data, base)) {
    out.verdict = Verdict::agrees;
    finish();
    return done();
  }
  flow.tell(3, 0.12,
            out.where.empty() ? "nothing located"
                              : out.where[0].body + ", " + out.where[0].phase + ": " +
                                    std::to_string(int(100 * out.where[0].share)) + " % of the misfit");
  flow.tell(4, 0.12, "screening " + std::to_string(out.candidates->size()) + " candidates");
  Fit named = base;
  for (int number = 1; number <= settings.max_effects; ++number) {
    Round round = run_round(flow, data, named, number);
    flow.files.write_fits(number, round.decision);
    const Decision& decision = round.decision;
    if (number == 1)
      for (const Judged& judged : decision.ranking) out.ranking.push_back(ranked(judged));
    if (decision.chosen < 0) break;
    const Judged& chosen = decision.ranking[std::size_t(decision.chosen)];
    if (number > 1 && closed(decision.base_error, chosen.error, 1) < 0.3) break;
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
    named = *chosen.fit;
    grown.push_back(named);
    out.fit_after = chosen.error;
    if (chosen.error < SECOND_LOOK) break;
    if (number < settings.max_effects)
      flow.tell(4, 0.6,
                "what " + named.model.parts.back()->label() + " leaves is " + std::to_string(chosen.error) +
                    " times the noise: looking for another effect");
  }
  flow.tell(6, 0.93, "judging on the held-out runs");
  const bool is_judged = finish();
  if (out.effects.empty() || !is_judged || out.gap_closed < LEAST_GAP_CLOSED || out.after >= out.before)
    out.verdict = Verdict::none;
  else
    out.verdict = verdict_of(out.effects);
  return done();
}

}  // namespace pvg::diagnose
