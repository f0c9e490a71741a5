// Where no known effect explains the misfit: its empirical shape. The laws of a dictionary (law_dictionary.hpp) at each
// place where they could act are switched on one by one in the simulator; the best sums of one, two and three of their
// signatures are compiled into a kernel, fitted and judged as effects are, and proved on the held-out runs. A law that
// was found so has no name: the verdict stays "none of these".
#pragma once
#include <optional>

#include "host/identify/search/workflow.hpp"

namespace pvg::diagnose {

// Sets of up to `most` columns by which the cost falls most, for each size the best `n_each`, smallest sets first.
std::vector<std::vector<std::size_t>> best_subsets(const Signatures& signatures, std::size_t most, std::size_t n_each);

struct Regressed {
  RegressedLaw law;
  std::vector<Curve> curves;  // of the held-out runs, then of the fitted ones
};

// The law that is found, or nothing where none closes enough of the gap on held-out runs. where: cells of the misfit;
// in_noise: errors are in units of the noise.
std::optional<Regressed> regress(Workflow& flow, const ChosenWindows& chosen, const std::vector<Cell>& where,
                                 bool in_noise);

// The same if there is time for it: a note says where there is not. unit: of held-out errors.
std::optional<Regressed> find_law(Workflow& flow, const ChosenWindows& chosen, const std::vector<Cell>& where,
                                  const std::string& unit);

}  // namespace pvg::diagnose
