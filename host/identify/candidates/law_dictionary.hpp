// Laws that a missing effort or force may follow, for a regression where no known effect explains what is missing: of a
// joint its position and rate, of a body its place and velocity. A law is text that the simulator compiles into a
// kernel (host/model/formula.hpp); a sum of laws with coefficients is an effect like any other.
#pragma once
#include <span>
#include <string>
#include <vector>

#include "host/identify/candidates/candidate.hpp"

namespace pvg::diagnose {

// One law of a site: its formulas without the coefficient, one of a joint, three of a body's force.
struct Law {
  std::vector<std::string> formulas;
  std::string shown;  // for people: r the distance from the origin, |v| the speed
};

struct LawSite {
  std::string effect, target;  // regressed_effort or regressed_force
  std::string unit;            // of a law's coefficient where the law has the size 1
  double scale = 1;            // an effort or force worth trying first [unit]
  std::vector<Law> laws;
};

// The places of a scene where something was measured that such a law could move: joints, by themselves or by places of
// the bodies they carry, and bodies that no joint carries. Widths of laws follow from how far and how fast things went.
std::vector<LawSite> law_sites(const Problem& problem);

// Sum of some laws of a site, each times a coefficient.
Effect law_effect(const LawSite& site, std::span<const std::size_t> laws, std::span<const double> coefficients);

// The same with the coefficients as the candidate's parameters. It is simulated as the sum of all laws of the site, the
// others with coefficients of 0, so that one kernel is compiled for all candidates of a site.
Candidate law_candidate(const LawSite& site, std::span<const std::size_t> laws);

// The sum for people, such as "-0.31 sin(3 * q) + 0.2 q".
std::string shown_sum(const LawSite& site, std::span<const std::size_t> laws, std::span<const double> coefficients);

}  // namespace pvg::diagnose
