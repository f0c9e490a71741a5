#include "host/identify/candidates/candidate.hpp"

#include <algorithm>
#include <map>

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

std::string unit_on(const PhysicalScene& scene, const std::string& target, const std::string& unit) {
  static const std::map<std::string, std::string> ALONG = {
      {"N m", "N"}, {"N m s/rad", "N s/m"}, {"N m/rad", "N/m"}, {"rad", "m"}, {"rad/s", "m/s"}};
  const auto joint = std::find_if(scene.joints.begin(), scene.joints.end(),
                                  [&](const Joint& candidate) { return candidate.name == target; });
  const auto along = ALONG.find(unit);
  const bool slides = joint != scene.joints.end() && joint->type == Joint::Type::prismatic;
  return slides && along != ALONG.end() ? along->second : unit;
}

std::vector<Candidate> make_candidates(const Problem& problem, const std::vector<std::string>& touching) {
  std::vector<Candidate> all;
  add_physical(problem, touching, all);
  add_parameters(problem, touching, all);
  add_measurement(problem, all);
  return all;
}

}  // namespace pvg::diagnose
