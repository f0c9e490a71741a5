// A second effect beside another first one: where two effects explain nearly as much by themselves the better one may
// be the wrong one, and beside it the second effect is never seen.
#pragma once
#include <vector>

#include "host/identify/search/workflow.hpp"

namespace pvg::diagnose {

// Whether two fits to the same windows leave the same, within the noise.
bool leave_the_same(const Fit& a, const Fit& b);

// Whether an effect closes enough of what `base` leaves for a second one to be looked for beside it; beside one that
// closes hardly anything is as beside none, and sums of two from there are pairs.hpp's.
bool is_worth_a_second(const Fit& base, const Fit& alternative);

// The fits of the first round (best first) that are worth a second effect: n_alternatives at most, each of which leaves
// another residual than the others and than those that were tried.
std::vector<Fit> alternatives_of(Workflow& flow, const FitData& data, const Fit& base,
                                 const std::vector<Fit>& first_round, std::vector<Fit> tried);

// Beside each alternative the effects that explain most of what it leaves, each pair from where both were found.
std::vector<Screened> pairs_beside(Workflow& flow, const std::vector<Candidate>& candidates, const FitData& data,
                                   const std::vector<Fit>& alternatives);

}  // namespace pvg::diagnose
