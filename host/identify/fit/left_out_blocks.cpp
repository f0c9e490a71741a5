#include "host/identify/fit/left_out_blocks.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "host/identify/criteria.hpp"
#include "host/identify/fit/fit_cost.hpp"
#include "host/identify/fit/normal_equations.hpp"

namespace pvg::diagnose {
namespace {

using Eigen::Index, Eigen::MatrixXd, Eigen::VectorXd;

// The numbers of a window's data outside one of its n_blocks equal stretches of time.
std::vector<Index> outside(const Window& window, std::size_t n_blocks, std::size_t block) {
  const auto [first, last] = std::minmax_element(window.data.begin(), window.data.end(),
                                                 [](const Datum& a, const Datum& b) { return a.sample < b.sample; });
  const std::size_t begin = first->sample, length = last->sample - begin + 1;
  std::vector<Index> kept;
  for (std::size_t i = 0; i < window.data.size(); ++i)
    if ((window.data[i].sample - begin) * n_blocks / length != block) kept.push_back(Index(i));
  return kept;
}

Reduced reduced_without(const Fit& fit, std::size_t w, const std::vector<Index>& kept) {
  Fit part;
  part.residual = {fit.residual[w](kept)};
  part.slope = {fit.slope[w](kept, Eigen::all)};
  part.of_start = {fit.of_start[w](kept, Eigen::all)};
  part.delta = {fit.delta[w]};
  part.scale = scale_of(fit, w);
  return reduce(part);
}

// Samples of the channel that has the most in this window.
std::size_t n_samples(const Window& window) {
  std::map<std::pair<int, int>, std::size_t> n_of;
  std::size_t most = 0;
  for (const Datum& d : window.data) most = std::max(most, ++n_of[{d.channel, d.component}]);
  return most;
}

std::size_t n_blocks_of(const Window& window, std::size_t n_windows, double correlated) {
  const std::size_t wanted = (criteria().interval_n_blocks + n_windows - 1) / n_windows;
  return std::clamp<std::size_t>(std::size_t(double(n_samples(window)) / correlated), 1, wanted);
}

}  // namespace

VectorXd left_out_blocks(const Fit& fit, const std::vector<Window>& windows, const MatrixXd& a, double correlated) {
  const Reduced whole = reduce(fit);
  std::vector<VectorXd> moved;
  for (std::size_t w = 0; w < windows.size(); ++w) {
    if (windows[w].data.empty()) continue;
    const std::size_t n = n_blocks_of(windows[w], windows.size(), correlated);
    for (std::size_t block = 0; block < n; ++block) {
      const std::vector<Index> kept = outside(windows[w], n, block);
      MatrixXd without = a - whole.a[w] + criteria().left_out_ridge * a;
      VectorXd g = -whole.g[w];
      if (!kept.empty()) {
        const Reduced rest = reduced_without(fit, w, kept);
        without += rest.a[0];
        g += rest.g[0];
      }
      moved.push_back(-inverse_in_own_units(without) * g);
    }
  }
  const double n = double(moved.size());
  VectorXd variance = VectorXd::Zero(a.rows()), mean = variance;
  if (moved.size() < criteria().interval_n_groups) return variance;
  for (const VectorXd& by : moved) mean += by / n;
  for (const VectorXd& by : moved) variance += (n - 1) / n * (by - mean).cwiseAbs2();
  return variance;
}

}  // namespace pvg::diagnose
