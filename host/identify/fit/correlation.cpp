#include "host/identify/fit/correlation.hpp"

#include <cmath>
#include <map>

#include "host/identify/criteria.hpp"

namespace pvg::diagnose {

double correlation_length(const std::vector<Window>& windows, const std::vector<Eigen::VectorXd>& residual) {
  std::vector<double> covariance(1 + criteria().correlation_lag_most, 0);
  double n = 0;
  for (std::size_t w = 0; w < windows.size(); ++w) {
    std::map<std::pair<int, int>, std::vector<double>> series;
    for (std::size_t i = 0; i < windows[w].data.size(); ++i) {
      const Datum& d = windows[w].data[i];
      series[{d.channel, d.component}].push_back(residual[w][Eigen::Index(i)]);
    }
    for (const auto& [channel, r] : series) {
      n += double(r.size());
      for (std::size_t lag = 0; lag <= criteria().correlation_lag_most; ++lag)
        for (std::size_t i = lag; i < r.size(); ++i) covariance[lag] += r[i] * r[i - lag];
    }
  }
  double length = 1;
  for (std::size_t lag = 1; lag <= criteria().correlation_lag_most && covariance[0] > 0; ++lag) {
    const double rho = covariance[lag] / covariance[0];
    if (rho < criteria().correlation_significant / std::sqrt(n)) break;
    length += 2 * rho;
  }
  return length;
}

}  // namespace pvg::diagnose
