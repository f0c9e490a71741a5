// Time stamps that are wrong by a little, each on its own (jitter). What moves at the rate v is then seen elsewhere:
//   sigma_i^2 = sigma^2 + (jitter v_i)^2,   v_i: (x_{i+1} - x_{i-1}) / (t_{i+1} - t_{i-1})
#pragma once
#include "host/identify/data/problem.hpp"

namespace pvg::diagnose {

// What the jitter of a channel adds to the noise of each of its numbers [n_samples x n, unit]; empty: nothing.
std::vector<double> jitter_noise(const Channel& channel, const std::vector<double>& t,
                                 const std::vector<double>& values);

// One standard deviation of the noise of one number, or of the channel around a time [the channel's unit].
double noise_of_number(const Problem& problem, const Run& run, std::size_t channel, std::size_t sample, int component);
double noise_around(const Problem& problem, const Run& run, std::size_t channel, double t0);

}  // namespace pvg::diagnose
