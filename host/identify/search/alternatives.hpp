// A second effect beside another first one: where two effects explain nearly as much by themselves the better one may
// be the wrong one, and beside it the second effect is never seen.
#pragma once
#include <optional>
#include <vector>

#include "host/identify/search/workflow.hpp"

namespace pvg::diagnose {

// Whether two fits to the same windows leave the same, within the noise.
bool leave_the_same(const Fit& a, const Fit& b);

// Whether an effect closes enough of what `base` leaves for a second one to be looked for beside it; beside one that
// closes hardly anything is as beside none, and sums of two from there are pairs.hpp's.
bool is_worth_a_second(const Fit& base, const Fit& alternative);

// A round beside each of the first two fits of the first round (best first) that are worth it and leave another
// residual than those that were tried. Returns the first pair that leaves less than `most` times the noise.
// expected_seconds: of a round.
std::optional<FoundPair> find_beside_alternatives(Workflow& flow, const std::vector<Candidate>& candidates,
                                                  const FitData& data, const Fit& base,
                                                  const std::vector<Fit>& first_round, std::vector<Fit> tried,
                                                  double most, double expected_seconds);

}  // namespace pvg::diagnose
