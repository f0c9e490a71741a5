// The alias table (Vose 1991): a number drawn by weights at a cost that does not depend on how many there are. A place
// is drawn evenly; it is kept with probability `keep`, else `other` is taken. Pure.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

namespace pvg {

struct AliasEntry {
  double keep = 1;
  std::uint32_t other = 0;
  double probability = 0;  // of this number: its share of the weights
};

// weights: finite, not negative, their sum positive
std::vector<AliasEntry> alias_table(std::span<const double> weights);

}  // namespace pvg
