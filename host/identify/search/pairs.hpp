// Two effects that explain the misfit only together. If they are searched one after the other, the first may
// explain part of both, and the second is never searched. So the best sums of two candidates' signatures are fitted
// together. Where two effects explain nearly as much by themselves the better one may be the wrong one, and beside it
// the second effect is never seen: so second effects are looked for beside the alternatives, too.
#pragma once
#include <optional>
#include <vector>

#include "host/identify/search/workflow.hpp"

namespace pvg::diagnose {

struct Pair {
  const Candidate *first = nullptr, *second = nullptr;
  Model model;      // at its linear optimum, inside the bounds
  double gain = 0;  // by which the cost would fall there, less (number of parameters) / 2 log(number of data)
};

// The best pairs, best first. No candidate is in more than n_pairs_of_one of them, so that not all pairs are one effect
// with whatever is beside it.
std::vector<Pair> best_pairs(const Signatures& signatures, double n_data);

// Whether two fits to the same windows leave the same, within the noise.
bool leave_the_same(const Fit& a, const Fit& b);

// Whether an effect closes enough of what `base` leaves for a second one to be looked for beside it; beside one that
// closes hardly anything is as beside none.
bool is_worth_a_second(const Fit& base, const Fit& alternative);

// The fits of the first round (best first) that are worth a second effect: n_alternatives at most, each of which leaves
// another residual than the others and than those that were tried.
std::vector<Fit> alternatives_of(Workflow& flow, const FitData& data, const Fit& base,
                                 const std::vector<Fit>& first_round, std::vector<Fit> tried);

// The pair that the decision names, if it leaves less than `most` times the noise: of the best sums, and of what is
// best beside each of the `alternatives` to the first effect.
// first_round: where its changes are known nothing else is screened, and fewer pairs are fitted.
struct FirstRound {
  const Signatures& signatures;
  const Changes& changes;
};
std::optional<FoundPair> find_pair(Workflow& flow, const std::vector<Candidate>& candidates, const FitData& data,
                                   const Fit& base, const std::vector<Fit>& alternatives, double most,
                                   const FirstRound& first_round);

}  // namespace pvg::diagnose
