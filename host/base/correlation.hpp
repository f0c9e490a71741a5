// How well one list of rates foretells another: success of policies in simulation and in reality.
#pragma once
#include <span>

namespace pvg {

// Pearson's correlation coefficient of pairs; NaN where one of the lists does not vary or there are fewer than two.
double pearson_correlation(std::span<const double> a, std::span<const double> b);

// Mean maximum rank violation (Li et al. 2024, "Evaluating real-world robot manipulation policies in simulation"): of
// each policy the largest difference in `real` to one that `predicted` puts in another order; their mean.
double mean_rank_violation(std::span<const double> predicted, std::span<const double> real);

struct RectifiedMean {
  double mean = 0, low = 0, high = 0;
};
// Mean of `real`, were it known for all of `all_predicted`: the mean prediction, corrected by the mean error of those
// pairs that are known; 95 % interval (Angelopoulos et al. 2023, "Prediction-powered inference", algorithm 1). NaN
// bounds where fewer than two pairs are known.
RectifiedMean rectified_mean(std::span<const double> all_predicted, std::span<const double> predicted,
                             std::span<const double> real);

}  // namespace pvg
