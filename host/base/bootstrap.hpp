// Interval of a mean of values that follow each other in time.
#pragma once
#include <cstddef>
#include <span>

namespace pvg {

struct MeanInterval {
  double mean = 0, low = 0, high = 0;  // all NaN for no value
};

// 95 % by the circular block bootstrap (Politis and Romano 1992): means of `n_resamples` series that are put together
// of random stretches of `stretch` neighbours, so that values that resemble their neighbours do not count as
// independent; 2.5 and 97.5 % of these means. The same numbers give the same interval.
MeanInterval bootstrap_mean(std::span<const double> values, std::size_t stretch, std::size_t n_resamples = 2000);

}  // namespace pvg
