// Two effects that explain the misfit only together. If they are searched one after the other, the first may
// explain part of both, and the second is never searched. So the best sums of two candidates' signatures are fitted
// together.
#pragma once
#include <optional>

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

// The pair that the decision names, if it leaves less than `most` times the noise: of the best sums, and of what is
// best beside each of the `alternatives` to the first effect.
std::optional<FoundPair> find_pair(Workflow& flow, const std::vector<Candidate>& candidates, const FitData& data,
                                   const Fit& base, const std::vector<Fit>& alternatives, double most);

}  // namespace pvg::diagnose
