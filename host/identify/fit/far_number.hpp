// A number of the scene that is wrong by factors, found before the time step is chosen: a stiffness that is 20 times
// too large would have all else simulated in steps that only this wrong stiffness needs.
#pragma once
#include <optional>
#include <vector>

#include "host/identify/fit/fit.hpp"

namespace pvg::diagnose {

struct FarNumber {
  Candidate number;
  double value = 0;
  double before = 0, after = 0;  // misfit of the scene as it stands, and with that value [noise]
};

// The parameter's usual value times each factor and over it, where its bounds allow.
std::vector<double> factors_away(const Parameter& parameter, const Series& factors);

// n values between two positive ones, neither of them, with equal ratios.
std::vector<double> ratios_between(double low, double high, std::size_t n);

// The number that explains nearly all of a misfit that is huge, alone and from the measured starts; none where there is
// no such number, or where anything is soft: each trial would take too long.
std::optional<FarNumber> find_far_number(Fitter& fitter, const Problem& problem);

}  // namespace pvg::diagnose
