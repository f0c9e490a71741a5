// Numbers of the scene that may be wrong: "retune". A number that is zero is none of them: what it describes is an
// effect that the scene lacks.
#include <algorithm>
#include <cstdio>

#include "host/identify/candidates/candidate.hpp"
#include "host/identify/criteria.hpp"
#include "host/identify/data/scene_number.hpp"

namespace pvg::diagnose {
namespace {

std::string as_the_scene_says(double value, const std::string& unit) {
  char text[60];
  std::snprintf(text, sizeof text, "%.4g", value);
  return "the scene says " + (text + (unit == "1" ? "" : " " + unit));
}

// What is known before any data: what the recording states, or else the habit that the row says.
void set_prior(Parameter& p, const Problem& problem, const SceneNumber& number, const NumberPlace& place) {
  p.prior_sigma = number.prior_sigma_share > 0 ? number.prior_sigma_share * place.value : number.prior_sigma;
  p.prior_is_habit = true;
  for (const NumberPrior& prior : problem.priors)
    if (prior.number == number.name && prior.target == place.target) {
      p.prior_sigma = prior.sigma;
      p.prior_is_habit = false;
    }
}

Candidate candidate_of(const Problem& problem, const SceneNumber& number, const NumberPlace& place) {
  const PhysicalScene& scene = problem.scene.scene;
  const std::string unit = unit_on(scene, place.target, number.unit);
  Candidate candidate{number.name,
                      place.target,
                      Family::parameter,
                      "scene",
                      "another value",
                      number.meaning,
                      as_the_scene_says(place.value, unit),
                      "a second motion in which this number matters differently",
                      {{"value", unit, number.low * place.value, number.high * place.value, place.value,
                        criteria().change_number * place.value}},
                      {},
                      number.log_prior};
  candidate.parameters[0].is_logarithmic = number.is_logarithmic;
  candidate.parameters[0].is_often_far = number.is_often_far;
  set_prior(candidate.parameters[0], problem, number, place);
  candidate.apply = [set = place.set](Variant& variant, std::span<const double> values) {
    set(variant.scene, values[0]);
  };
  candidate.amend = [&number, target = place.target, said = place.value](const SceneFile& file,
                                                                         std::span<const double> values) {
    return number.write({file.root, target, values[0], values[0] / said, file.amended});
  };
  return candidate;
}

Candidate nuisance_of(const Problem& problem, const SceneNumber& number, const NumberPlace& place) {
  Candidate nuisance = candidate_of(problem, number, place);
  nuisance.is_nuisance = true;
  Parameter& p = nuisance.parameters[0];
  p.low = std::max(p.low, p.off - criteria().prior_reach * p.prior_sigma);
  p.high = std::min(p.high, p.off + criteria().prior_reach * p.prior_sigma);
  p.scale = p.prior_sigma;
  p.is_logarithmic = p.is_often_far = false;  // it is not far off
  return nuisance;
}

}  // namespace

std::vector<CandidateKind> parameter_kinds() {
  std::vector<CandidateKind> list;
  for (const SceneNumber& number : scene_numbers())
    list.push_back({number.name,
                    "scene",
                    "another value",
                    number.meaning,
                    Family::parameter,
                    {{"value", number.unit, 0, 1e12, 0, 1}}});
  return list;
}

std::vector<Candidate> nuisances_of(const Problem& problem) {
  std::vector<Candidate> nuisances;
  for (const NumberPrior& prior : problem.priors)
    for (const SceneNumber& number : scene_numbers()) {
      if (prior.number != number.name) continue;
      const bool is_whole = prior.target == "scene";
      for (const NumberPlace& place : number.places(problem.scene.scene, {is_whole ? "scene/scene" : prior.target}))
        if (place.target == prior.target) nuisances.push_back(nuisance_of(problem, number, place));
    }
  return nuisances;
}

void add_parameters(const Problem& problem, const std::vector<std::string>& touching, std::vector<Candidate>& out) {
  for (const SceneNumber& number : scene_numbers())
    for (const NumberPlace& place : number.places(problem.scene.scene, touching))
      if (place.value > 0) out.push_back(candidate_of(problem, number, place));
}

}  // namespace pvg::diagnose
