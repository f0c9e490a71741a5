#include "host/identify/fit/limits.hpp"

#include <algorithm>
#include <cmath>

#include "host/identify/criteria.hpp"
#include "host/identify/fit/fit_cost.hpp"

namespace pvg::diagnose {
namespace {

constexpr int N_BETWEEN = 7;  // between one that is felt and its double

// Whether each value of the candidate's only parameter changes the residuals; a failed simulation counts as a change.
std::vector<char> is_felt(Fitter& fitter, const FitData& data, const Fit& base, const Candidate& candidate,
                          const std::vector<double>& values) {
  std::vector<Model> models;
  for (const double value : values)
    models.push_back(
        joined(base.model, {{&candidate}, Eigen::VectorXd::Constant(1, value), Eigen::VectorXd::Constant(1, value)}));
  const auto found = fitter.evaluate(data, models, std::vector(models.size(), base.delta));
  std::vector<char> felt;
  for (const std::vector<Prediction>& windows : found) {
    std::vector<Eigen::VectorXd> change;
    bool succeeded = true;
    for (std::size_t w = 0; w < windows.size(); ++w) {
      succeeded = succeeded && windows[w].succeeded;
      if (succeeded) change.push_back(windows[w].residual - base.residual[w]);
    }
    felt.push_back(!succeeded || rms(change) > criteria().limit_felt);
  }
  return felt;
}

// The index of the highest of descending values that changes the residuals; their number if none does.
std::size_t first_felt(const std::vector<char>& felt) {
  return std::size_t(std::find(felt.begin(), felt.end(), char(true)) - felt.begin());
}

}  // namespace

void place_limits(Fitter& fitter, const FitData& data, const Fit& base, std::vector<Candidate>& candidates) {
  for (Candidate& candidate : candidates) {
    if (candidate.parameters.size() != 1 || !candidate.parameters[0].is_limit) continue;
    Parameter& limit = candidate.parameters[0];
    std::vector<double> values;
    for (double value = std::min(limit.high, criteria().limit_highest);
         value > std::max(limit.low, criteria().limit_lowest); value /= 2)
      values.push_back(value);
    const std::size_t coarse = first_felt(is_felt(fitter, data, base, candidate, values));
    if (coarse == values.size()) continue;
    const double felt = values[coarse];
    values.clear();
    for (int k = N_BETWEEN; k >= 0; --k) values.push_back(felt * std::exp2(double(k) / (N_BETWEEN + 1)));
    const std::size_t fine = first_felt(is_felt(fitter, data, base, candidate, values));
    const double ratio = std::exp2(1.0 / (N_BETWEEN + 1));
    limit.off = limit.high = values.at(fine) * ratio;  // the last of them is `felt` again
    limit.scale = limit.off - limit.off / ratio;
  }
}

}  // namespace pvg::diagnose
