#include "host/identify/candidates/candidate.hpp"

namespace pvg::diagnose {

const char* family_name(Family family) {
  constexpr const char* NAMES[] = {"physical", "parameter", "measurement"};
  return NAMES[int(family)];
}

std::vector<CandidateKind> candidate_kinds() {
  std::vector<CandidateKind> all;
  for (const auto& part : {physical_kinds(), parameter_kinds(), measurement_kinds()})
    all.insert(all.end(), part.begin(), part.end());
  return all;
}

std::vector<Candidate> make_candidates(const Problem& problem, const std::vector<std::string>& touching) {
  std::vector<Candidate> all;
  add_physical(problem, touching, all);
  add_parameters(problem, touching, all);
  add_measurement(problem, all);
  return all;
}

}  // namespace pvg::diagnose
