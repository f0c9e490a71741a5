// Whether residuals are noise, by statistics: the sums of their squares over blocks of 1, 4, 16, 64 and 256 samples of
// a channel, which are chi-squared if the residuals are white and of the noise's size. Single samples tell that the
// errors are larger than the noise, long blocks that something drifts. The noise's own uncertainty and the error of the
// time step belong to what is allowed.
#pragma once
#include <string>
#include <vector>

#include "host/identify/data/window.hpp"

namespace pvg::diagnose {

struct Agreement {
  double sigmas = 0;         // of the most significant excess, in standard deviations of a normal distribution
  std::string channel;       // whose
  std::size_t n_block = 1;   // samples of its blocks
  double size = 0;           // root mean square of the residuals' means over blocks, times the root of n_block [noise]
  bool is_agreement = true;  // no excess is significant
};

// residual: [n_windows][n_data, noise]
Agreement agreement_of(const Problem& problem, const std::vector<Window>& windows,
                       const std::vector<Eigen::VectorXd>& residual);

// Relative standard deviation of a channel's noise: of third differences 1.53 / sqrt(n), for n samples.
double noise_uncertainty(const Problem& problem, std::size_t channel);

bool any_noise_is_assumed(const Problem& problem);

// "position of joint hinge, means over 16 samples: 1.9 times the noise, 8.2 standard deviations"
std::string text_of(const Agreement& agreement);

}  // namespace pvg::diagnose
