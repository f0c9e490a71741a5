#include "host/identify/fit/far_number.hpp"

#include <cmath>

#include "host/base/statistics.hpp"
#include "host/identify/criteria.hpp"

namespace pvg::diagnose {
namespace {

// Numbers of the scene of which nothing is known before any data.
std::vector<Candidate> unknown_numbers(const Problem& problem) {
  std::vector<Candidate> candidates = make_candidates(problem, {});
  std::erase_if(candidates, [](const Candidate& c) {
    return c.family != Family::parameter || c.parameters.size() != 1 || c.parameters[0].prior_sigma > 0 ||
           !std::isfinite(c.parameters[0].off);
  });
  return candidates;
}

struct Place {
  const Candidate* number = nullptr;
  double value = 0, misfit = INFINITY;
};

// Median over the windows of the root mean square of the residuals with the measured starts [noise].
double misfit_of(const std::vector<Prediction>& windows) {
  std::vector<double> of_window;
  for (const Prediction& window : windows)
    of_window.push_back(window.succeeded ? rms({window.residual}) : double(INFINITY));
  if (of_window.empty()) return INFINITY;
  return upper_median(std::move(of_window));
}

void find_misfits(Fitter& fitter, const FitData& data, std::vector<Place>& places) {
  std::vector<Model> models;
  for (const Place& place : places) {
    models.push_back(model_of({place.number}));
    models.back().x[0] = place.value;
  }
  const auto found = fitter.evaluate(data, models, {});
  for (std::size_t i = 0; i < places.size(); ++i) places[i].misfit = misfit_of(found[i]);
}

Place least(const std::vector<Place>& places) {
  Place best;
  for (const Place& place : places)
    if (place.misfit < best.misfit) best = place;
  return best;
}

// The neighbours of a value among those that were tried; itself where it is the last one.
std::pair<double, double> neighbours(const std::vector<Place>& places, const Place& of) {
  double below = of.value, above = of.value;
  for (const Place& place : places) {
    if (place.number != of.number) continue;
    if (place.value < of.value && (below == of.value || place.value > below)) below = place.value;
    if (place.value > of.value && (above == of.value || place.value < above)) above = place.value;
  }
  return {below, above};
}

}  // namespace

std::vector<double> factors_away(const Parameter& parameter, const Series& factors) {
  std::vector<double> values;
  for (const double factor : factors)
    for (const double value : {parameter.off * factor, parameter.off / factor})
      if (value >= parameter.low && value <= parameter.high) values.push_back(value);
  return values;
}

std::vector<double> ratios_between(double low, double high, std::size_t n) {
  std::vector<double> values;
  for (std::size_t i = 1; i <= n; ++i) values.push_back(low * std::pow(high / low, double(i) / double(n + 1)));
  return values;
}

std::optional<FarNumber> find_far_number(Fitter& fitter, const Problem& problem) {
  const PhysicalScene& scene = problem.scene.scene;
  if (!scene.soft_bodies.empty() || !scene.cloths.empty()) return std::nullopt;
  const FitData data = fitter.prepare(
      make_windows(problem, false, problem.can_restart ? criteria().step_window : 0, criteria().step_n_windows), {},
      false);
  const std::vector<Candidate> numbers = unknown_numbers(problem);
  if (data.windows.empty() || numbers.empty()) return std::nullopt;
  const double before = misfit_of(fitter.evaluate(data, {Model{}}, {}).front());
  if (!(before > criteria().far_misfit_least) || !std::isfinite(before)) return std::nullopt;
  std::vector<Place> places;
  for (const Candidate& number : numbers)
    for (const double value : factors_away(number.parameters[0], criteria().screen_factors))
      places.push_back({&number, value});
  find_misfits(fitter, data, places);
  for (const Candidate& number : numbers) places.push_back({&number, number.parameters[0].off, before});
  for (std::size_t i = 0; i < criteria().far_n_refinements; ++i) {
    const Place best = least(places);
    if (!(best.misfit < before)) return std::nullopt;
    const auto [below, above] = neighbours(places, best);
    std::vector<Place> finer;
    for (const auto& [low, high] : {std::pair(below, best.value), std::pair(best.value, above)})
      if (low < high)
        for (const double value : ratios_between(low, high, criteria().far_n_between))
          finer.push_back({best.number, value});
    find_misfits(fitter, data, finer);
    places.insert(places.end(), finer.begin(), finer.end());
  }
  const Place best = least(places);
  if (!(best.misfit < criteria().far_leaves_most * before)) return std::nullopt;
  return FarNumber{*best.number, best.value, before, best.misfit};
}

}  // namespace pvg::diagnose
