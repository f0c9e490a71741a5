#include "host/render/alias_table.hpp"

#include <algorithm>
#include <numeric>

namespace pvg {

std::vector<AliasEntry> alias_table(std::span<const double> weights) {
  const double sum = std::accumulate(weights.begin(), weights.end(), 0.0);
  std::vector<AliasEntry> table(weights.size());
  std::vector<double> scaled(weights.size());
  std::vector<std::uint32_t> small, large;
  for (std::uint32_t i = 0; i < weights.size(); ++i) {
    table[i].probability = weights[i] / sum;
    table[i].other = i;
    scaled[i] = table[i].probability * double(weights.size());
    (scaled[i] < 1 ? small : large).push_back(i);
  }
  // a small one fills its place up with a part of a large one
  while (!small.empty() && !large.empty()) {
    const std::uint32_t i = small.back(), j = large.back();
    small.pop_back();
    table[i].keep = scaled[i];
    table[i].other = j;
    scaled[j] -= 1 - scaled[i];
    if (scaled[j] < 1) {
      large.pop_back();
      small.push_back(j);
    }
  }
  // what is left is 1 up to rounding; but what has no weight must never be kept
  for (const std::uint32_t i : small)
    if (weights[i] == 0)
      table[i] = {0, std::uint32_t(std::max_element(weights.begin(), weights.end()) - weights.begin()), 0};
  return table;
}

}  // namespace pvg
