// The alias table: numbers come as often as their weights say.
#include "host/render/alias_table.hpp"

#include <gtest/gtest.h>

namespace pvg {
namespace {

TEST(AliasTable, DrawsInProportionToTheWeights) {
  const std::vector<double> weights = {0, 1, 5, 0.25, 3, 0};
  const std::vector<AliasEntry> table = alias_table(weights);
  std::vector<double> share(weights.size(), 0);
  for (std::size_t i = 0; i < table.size(); ++i) {
    share[i] += table[i].keep / double(table.size());
    share[table[i].other] += (1 - table[i].keep) / double(table.size());
  }
  for (std::size_t i = 0; i < weights.size(); ++i) {
    EXPECT_NEAR(share[i], weights[i] / 9.25, 1e-12);
    EXPECT_NEAR(table[i].probability, weights[i] / 9.25, 1e-12);
  }
}

}  // namespace
}  // namespace pvg
