#include "host/identify/fit/limits.hpp"

#include <algorithm>
#include <cmath>

#include "host/identify/criteria.hpp"
#include "host/identify/fit/fit_cost.hpp"

namespace pvg::diagnose {
namespace {

constexpr int N_BETWEEN = 7;  // between one that is felt and its double

// Whether a value of the candidate's only parameter changes the residuals; a failed simulation counts as a change.
bool is_felt(Fitter& fitter, const FitData& data, const Fit& base, const Candidate& candidate, double value) {
  const Eigen::VectorXd x = Eigen::VectorXd::Constant(1, value);
  const std::vector<Prediction> windows =
      fitter.evaluate(data, {joined(base.model, {{&candidate}, x, x})}, {base.delta}).front();
  std::vector<Eigen::VectorXd> change;
  for (std::size_t w = 0; w < windows.size(); ++w) {
    if (!windows[w].succeeded) return true;
    change.push_back(windows[w].residual - base.residual[w]);
  }
  return rms(change) > criteria().limit_felt;
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
    // the highest one that is felt: those below it are felt, too
    const auto is_silent = [&](double value) { return !is_felt(fitter, data, base, candidate, value); };
    const auto coarse = std::partition_point(values.begin(), values.end(), is_silent);
    if (coarse == values.end()) continue;
    const double felt = *coarse;
    values.clear();
    for (int k = N_BETWEEN; k > 0; --k) values.push_back(felt * std::exp2(double(k) / (N_BETWEEN + 1)));
    const auto fine = std::partition_point(values.begin(), values.end(), is_silent);
    const double ratio = std::exp2(1.0 / (N_BETWEEN + 1));
    limit.off = limit.high = (fine == values.end() ? felt : *fine) * ratio;
    limit.scale = limit.off - limit.off / ratio;
  }
}

}  // namespace pvg::diagnose
