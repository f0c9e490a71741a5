// Stage 1, the measurement first: the noise of each channel, where the recording does not say it.
#pragma once
#include "host/identify/data/problem.hpp"

namespace pvg::diagnose {

// One standard deviation of white noise on samples of a smooth motion, from third differences of even samples: those of
// noise alone have the variance 20 sigma^2, and neighbours of them correlate by -15 / 20. Where they do not, as what a
// tracker smooths or a clock repeats, they are taken of samples further apart until they do, at most eight. The median
// over the differences leaves impacts out. At least the step of a quantised sensor divided by sqrt(12). NaN: too few
// samples.
double noise_of(const std::vector<double>& values, std::size_t width);

// What a channel says by itself: its samples, as many as its own rate gives, with NaN where one of them is missing.
// t [n, s], values [n x width]; a row without any number is no sample. Recordings hold channels of different rates.
std::vector<double> own_samples(const std::vector<double>& t, const std::vector<double>& values, std::size_t width);

// Fills in the sigma of channels whose noise is unknown, the median over the runs, and the noise scale of those
// runs whose own noise is more than twice that. That of video holds what 8 bits leave. Where two runs have the same
// commands, noise is what they do not share.
void measure_noise(Problem& problem);

// How large the noise of a channel is, and how that is known.
std::string noise_sentence(const Channel& channel);

// Where scene and runs agree because of a noise that nobody knows: lowers the sigma of such channels until `error`
// [noise] is noise_supposed, or to their least_sigma. Returns what was supposed, as the beginning of a sentence; empty:
// the noise is known.
std::string suppose_less_noise(Problem& problem, double error);

}  // namespace pvg::diagnose
