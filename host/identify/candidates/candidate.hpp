// What may explain a residual: an effect that the scene lacks, a number of the scene that is wrong, or an error of a
// sensor. Each has a name, a target, parameters with bounds, and changes a variant by them.
#pragma once
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "host/identify/data/scene_entry.hpp"
#include "host/identify/sensing/rollout.hpp"

namespace YAML {
class Node;
}

namespace pvg::diagnose {

enum class Family { physical, parameter, measurement };
const char* family_name(Family family);

struct Parameter {
  std::string name, unit;
  double low = 0, high = 0, off = 0;  // with `off` the candidate changes nothing
  double scale = 1;                   // a change of this size is worth trying first
  double prior_sigma = 0;             // one standard deviation from `off` of what is known before any data; 0: anything
  bool prior_is_habit = false;  // the prior is one of scenes in general (prior.hpp), of this one nothing is stated
  bool is_shape = false;        // does nothing while the others are off
  bool is_limit = false;        // does nothing where it is higher than what the runs reach (limits.hpp)
  bool is_logarithmic = false;  // positive, and may be wrong by factors: steps are those of its logarithm
  bool is_often_far = false;    // also tried at factors of its value
};

// The scene file to which a diagnosis writes what it found.
struct SceneFile {
  YAML::Node& root;
  const Problem& problem;
  const PhysicalScene& amended;  // the scene with what was found
};

struct Candidate {
  std::string name, target;
  Family family = Family::physical;
  std::string site, law, meaning, equation, experiment;
  std::vector<Parameter> parameters;
  std::function<void(Variant&, std::span<const double>)> apply;
  double log_prior = 0;  // log of how likely it is before any data, relative to others that explain as much
  // Writes the values into the scene file. False where the file does not say such a number itself.
  std::function<bool(const SceneFile&, std::span<const double>)> amend = {};
  // A number that the recording states with a standard deviation: free in every model, near what is stated, and no
  // effect that is named (nuisance parameter).
  bool is_nuisance = false;
  std::string label() const { return name + " at " + target; }
};

// A kind of candidate, for the list of all.
struct CandidateKind {
  std::string name, site, law, meaning;
  Family family = Family::physical;
  std::vector<Parameter> parameters;
};
std::vector<CandidateKind> candidate_kinds();

// All that this problem's scene and channels allow. touching: pairs of bodies that touch in the runs, FIRST/SECOND.
std::vector<Candidate> make_candidates(const Problem& problem, const std::vector<std::string>& touching);

// The numbers that the recording states with a standard deviation, within prior_reach of them.
std::vector<Candidate> nuisances_of(const Problem& problem);

// Adds an effect to the section `effects` of a scene file.
void write_effect(YAML::Node& root, const Effect& effect);

// The amendment of a candidate that adds an effect to the scene.
bool amend_last_effect(const SceneFile& file, std::span<const double> values);

// physical_candidates.cpp, parameter_candidates.cpp, measurement_candidates.cpp
void add_physical(const Problem& problem, const std::vector<std::string>& touching, std::vector<Candidate>& out);
void add_parameters(const Problem& problem, const std::vector<std::string>& touching, std::vector<Candidate>& out);
void add_measurement(const Problem& problem, std::vector<Candidate>& out);
std::vector<CandidateKind> physical_kinds();
std::vector<CandidateKind> parameter_kinds();
std::vector<CandidateKind> measurement_kinds();

}  // namespace pvg::diagnose
