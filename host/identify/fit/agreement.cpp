#include "host/identify/fit/agreement.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "host/identify/criteria.hpp"

namespace pvg::diagnose {
namespace {

// One channel's residuals in one window, in the order of time, and what the time step may add to each.
struct Stretch {
  std::vector<double> residual, step_error;
};

struct Sum {
  double squares = 0, of_step = 0, n = 0;
};

// Where the time step's error is not corrected it is not known either, so the errors may be larger by agrees_rms.
double step_error_of(const Window& window, std::size_t i) {
  if (window.correction.size() > 0) return criteria().step_error_left * window.correction[Eigen::Index(i)];
  return NAN;
}

Sum blocks_of(const std::vector<Stretch>& stretches, std::size_t n_block) {
  const double unknown = criteria().agrees_rms * criteria().agrees_rms - 1;
  Sum sum;
  for (const Stretch& stretch : stretches)
    for (std::size_t first = 0; first + n_block <= stretch.residual.size(); first += n_block) {
      double r = 0, step = 0;
      for (std::size_t i = first; i < first + n_block; ++i) r += stretch.residual[i], step += stretch.step_error[i];
      sum.squares += r * r / double(n_block);
      sum.of_step += std::isfinite(step) ? step * step / double(n_block) : unknown;
      sum.n += 1;
    }
  return sum;
}

// The normal deviate of chi-squared with n degrees of freedom (Wilson, Hilferty 1931).
double deviate(double squares, double n) {
  const double spread = 2 / (9 * n);
  return (std::cbrt(squares / n) - (1 - spread)) / std::sqrt(spread);
}

std::map<int, std::vector<Stretch>> stretches_of(const std::vector<Window>& windows,
                                                 const std::vector<Eigen::VectorXd>& residual) {
  std::map<int, std::vector<Stretch>> of_channel;
  for (std::size_t w = 0; w < windows.size(); ++w) {
    std::map<std::pair<int, int>, Stretch> columns;
    for (std::size_t i = 0; i < windows[w].data.size(); ++i) {
      const Datum& datum = windows[w].data[i];
      Stretch& stretch = columns[{datum.channel, datum.component}];
      stretch.residual.push_back(residual[w][Eigen::Index(i)]);
      stretch.step_error.push_back(step_error_of(windows[w], i));
    }
    for (auto& [column, stretch] : columns) of_channel[column.first].push_back(std::move(stretch));
  }
  return of_channel;
}

}  // namespace

double noise_uncertainty(const Problem& problem, std::size_t channel) {
  const Channel& c = problem.channels[channel];
  if (c.is_noise_known) return criteria().noise_given_uncertainty;
  double n = 0;
  for (const Run& run : problem.runs)
    n += double(std::count_if(run.values[channel].begin(), run.values[channel].end(),
                              [](double value) { return std::isfinite(value); }));
  return std::hypot(criteria().noise_given_uncertainty,
                    criteria().noise_third_differences / std::sqrt(std::max(n, 1.0)));
}

bool any_noise_is_assumed(const Problem& problem) {
  return std::any_of(problem.channels.begin(), problem.channels.end(),
                     [](const Channel& channel) { return channel.is_noise_assumed; });
}

Agreement agreement_of(const Problem& problem, const std::vector<Window>& windows,
                       const std::vector<Eigen::VectorXd>& residual) {
  Agreement worst;
  for (const auto& [channel, stretches] : stretches_of(windows, residual)) {
    const double larger = 1 + criteria().gain_sigma * noise_uncertainty(problem, std::size_t(channel));
    for (const double length : criteria().agreement_blocks) {
      const std::size_t n_block = std::size_t(std::max(1.0, std::round(length)));
      const Sum sum = blocks_of(stretches, n_block);
      if (sum.n < 1) continue;
      const double sigmas = deviate(std::max(sum.squares - sum.of_step, 0.0) / (larger * larger), sum.n);
      if (sigmas <= worst.sigmas) continue;
      worst.sigmas = sigmas;
      worst.channel = problem.channels[std::size_t(channel)].name;
      worst.n_block = n_block;
      worst.size = std::sqrt(sum.squares / sum.n);
    }
  }
  worst.is_agreement = worst.sigmas <= criteria().agrees_sigma;
  return worst;
}

std::string text_of(const Agreement& agreement) {
  const std::string blocks =
      agreement.n_block > 1 ? fmt::format(", means over {} samples", agreement.n_block) : std::string();
  return fmt::format("{}{}: {:.3g} times the noise, {:.1f} standard deviations more than noise gives",
                     agreement.channel, blocks, agreement.size, agreement.sigmas);
}

}  // namespace pvg::diagnose
