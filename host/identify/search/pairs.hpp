// Two effects that only explain together: one after the other, the first may stand in for both and the second never be
// looked for. The best sums of two candidates' signatures are fitted together.
#pragma once
#include <optional>

#include "host/identify/search/workflow.hpp"

namespace pvg::diagnose {

struct Pair {
  const Candidate *first = nullptr, *second = nullptr;
  Model model;      // at its linear optimum, inside the bounds
  double gain = 0;  // by which the cost would fall there, less (number of parameters) / 2 log(number of data)
};

// The best pairs, best first; no candidate stands in more than MOST_OF_ONE of them, lest all be one effect with
// whatever stands beside it.
inline constexpr std::size_t MOST_PAIRS = 8, MOST_OF_ONE = 3;
std::vector<Pair> best_pairs(const Signatures& signatures, double n_data);

// The pair that is decided for, if it leaves less than `most` times the noise, into `out.ranking` and
// `out.inseparable`.
std::optional<Fit> find_pair(Workflow& flow, const FitData& data, const Fit& base, double most);

}  // namespace pvg::diagnose
